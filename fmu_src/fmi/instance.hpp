/// One instance of the component: its scene, its values, its place in the standard's life cycle.
#pragma once
#include <array>
#include <memory>

#include "estimate.hpp"
#include "logger.hpp"
#include "model/basis.hpp"
#include "scene_file.hpp"
#include "soft_body.hpp"
#include "state_blob.hpp"
#include "variable_table.hpp"

namespace softffd::fmi {

/// States of the FMI 2.0 co-simulation state machine, as bits for masks.
enum Phase : unsigned { instantiated = 1, initializing = 2, stepping = 4, step_failed = 8, terminated = 16, failed = 32 };

/// A call that the host got wrong or that cannot be done; what() is the message for the log.
struct CallError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Highest order of the time derivatives that inputs take: forces and loads, and the others.
inline constexpr int highest_order = 3;
inline int highest_order_of(Family family) { return family == Family::force || family == Family::load ? highest_order : 1; }

class Instance {
 public:
  Instance(SceneFile scene, Logger logger);

  Phase phase = instantiated;
  Logger logger;

  /// Back to the state right after instantiation.
  void reset();
  void setup_experiment(double start_time, double tolerance, double stop_time);  ///< tolerance <= 0, stop_time infinite: not given
  void enter_initialization();
  void exit_initialization();
  fmi2Status do_step(double time, double step);

  /// Real, Integer and Enumeration variables share one access path. Throws CallError naming the variable; sets all or nothing.
  void set(Type type, const fmi2ValueReference* references, std::size_t count, const double* values);
  void get(Type type, const fmi2ValueReference* references, std::size_t count, double* values);

  /// Time derivatives of Real inputs; they hold for the next step only. Orders 1 to 3 of forces and loads, order 1 of the others.
  void set_input_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, const double* values);
  /// First time derivatives of positions and probes.
  void get_output_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, double* values);

  /// Everything that makes the instance continue as it would have, as flat bytes.
  Bytes save_state();
  /// Continues from saved bytes. Throws StateError, changing nothing, if they are none of this scene.
  void load_state(const Bytes& bytes);
  const std::string& guid() const { return scene_.guid; }

  double last_successful_time() const { return time_; }

  /// Name of a variable as in modelDescription.xml; the bare number for an unknown one.
  std::string name(fmi2ValueReference reference) const;

 private:
  struct Variable {
    const FamilyInfo* info;
    int index;
  };
  std::size_t part_count(Part part) const;
  std::string instance_name_of(Part part, int instance) const;
  int control_point_of(Part part, int instance) const;
  void count_variables();
  std::optional<Variable> find(fmi2ValueReference reference) const;
  Variable checked(fmi2ValueReference reference, Type type) const;
  void check_settable(const Variable& variable, fmi2ValueReference reference, double value) const;
  bool available(double method) const;
  double output(Family family, int index);
  std::vector<double>& values(Family family) { return values_[std::size_t(family)]; }
  Vec3 rate3(Family family, int instance, int order = 1) {
    return Eigen::Map<const Vec3>(rates_[order - 1][std::size_t(family)].data() + 3 * instance);
  }
  Vec3 value3(Family family, int instance) { return Eigen::Map<const Vec3>(values(family).data() + 3 * instance); }
  void load_starts();
  void start(Family family, std::initializer_list<double> numbers);
  void apply_values();
  void apply_rates();
  void apply_force_rates(int order, Points& rate);
  void forget_rates();
  void ensure_initial_state();
  std::string describe(StepStatus status, double time, double step) const;
  std::string describe_undecided() const;
  std::string start_behind_planes() const;
  void log_solver_choice();
  void warn_of_folding();
  void warn_of_gain();
  void warn_of_division();
  void warn_of_turning();
  void warn_of_start();

  SceneFile scene_;
  std::vector<int> input_planes_, fixed_planes_, input_pins_;  ///< indices into scene_.planes and scene_.pins
  std::vector<Embedding> probes_;
  std::array<std::size_t, 128> counts_{};  ///< variables by family id
  /// Time derivatives of inputs for the next step by order - 1 and family id.
  std::array<std::array<std::vector<double>, 128>, highest_order> rates_;
  bool rated_ = false;                           ///< any rate was set
  std::array<std::vector<double>, 128> values_;  ///< settings by family id
  SoftBody body_;
  std::optional<ErrorEstimate> error_estimate_;  ///< only if the scene asks for it
  bool changed_ = true;                          ///< values differ from what the body has
  bool material_changed_ = true;                 ///< among them mass, stiffness or damping
  double start_time_ = 0, time_ = 0, stop_time_;
  int logged_method_ = -1;
  bool warned_of_rubbing_ = false, warned_of_gain_ = false, warned_of_division_ = false, warned_of_turning_ = false;
  Reason logged_reason_ = Reason::asked;
  double logged_step_ = -1, logged_share_ = 1;
  bool warned_of_folding_ = false;
};

}  // namespace softffd::fmi
