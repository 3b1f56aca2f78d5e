/// What an instance reports of its own accord: the method it takes and why, and warnings, each once in a run.
#pragma once
#include "messages/logger.hpp"
#include "resource/scene_file.hpp"

namespace softffd::fmi {

class Messages {
 public:
  /// Both must outlive this.
  Messages(const SceneFile& scene, const Logger& logger) : scene_(scene), logger_(logger) {}

  /// A new run: everything may be reported again.
  void reset() { reported_ = {}; }
  /// fmi2SetupExperiment was left out.
  void not_set_up();
  /// Looks at the initial state; time [s].
  void begun(const SoftBody& body, double time);
  /// Looks at a communication step of this length [s] that has been done and has led to this time [s].
  void stepped(SoftBody& body, double time, double length);

 private:
  enum Topic : unsigned { rubbing = 1, folding = 2, gain = 4, division = 8, turning = 16, set_up = 32, jump = 64, friction = 128 };
  struct Reported {
    unsigned topics = 0;
    std::optional<Method> method;
    Reason reason = Reason::asked;
    double step = -1, step_factor = 1;
    double error = 0;  ///< the largest that has been stated [m]
  };
  /// Gives the warning that `text` returns, unless it is empty or there was one of this topic before.
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
  void warn_of_folding(const SoftBody& body, double time);

  const SceneFile& scene_;
  const Logger& logger_;
  Reported reported_;
};

}  // namespace softffd::fmi
