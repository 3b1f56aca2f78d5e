/// Reports that an instance makes unasked: the method that it uses and the reason, and warnings, each once in a run.
#pragma once
#include "messages/logger.hpp"
#include "resource/scene_file.hpp"

namespace softffd::fmi {

class Messages {
 public:
  /// Scene and logger must outlive the object.
  Messages(const SceneFile& scene, const Logger& logger) : scene_(scene), logger_(logger) {}

  /// Begins a new run, in which everything may be reported again.
  void reset() { reported_ = {}; }
  /// Reports that fmi2SetupExperiment was not called.
  void not_set_up();
  /// Reports that the parameter solver.tolerance was set and the host gave another tolerance, and which of them is used.
  void two_tolerances(double set, double asked, bool asked_wins);
  /// Reports on the initial state at this time [s].
  void begun(const SoftBody& body, double time);
  /// Reports on a communication step of this length [s], which has just ended at this time [s]. estimated: error that the error estimate
  /// states [m]; 0 if the scene has none.
  void stepped(SoftBody& body, double time, double length, double estimated);

 private:
  enum Topic : unsigned { rubbing = 1, folding = 2, gain = 4, division = 8, turning = 16, set_up = 32, jump = 64, friction = 128 };
  struct Reported {
    unsigned topics = 0;
    std::optional<Method> method;
    Reason reason = Reason::asked;
    double step = -1, step_factor = 1;
    double error = 0;  ///< largest error reported so far, stated or estimated [m]
  };
  /// Logs the warning that `text` returns, unless the warning is empty or there was a warning of this topic before.
  template <class Text>
  void once(Topic topic, Text&& text) {
    if (reported_.topics & topic) return;
    const std::string warning = text();
    if (warning.empty()) return;
    reported_.topics |= topic;
    logger_.log(fmi2Warning, log_warning, warning);
  }
  void report_threads();
  void report_choice(SoftBody& body);
  void report_step_factor(const SoftBody& body, double time);
  void report_error(const SoftBody& body, double time);
  void report_estimate(const SoftBody& body, double time, double estimated);
  void warn_of_folding(const SoftBody& body, double time);

  const SceneFile& scene_;
  const Logger& logger_;
  Reported reported_;
};

}  // namespace softffd::fmi
