/// One instance of the component: its scene, its variables, and its phase in the standard's life cycle.
#pragma once
#include "instance/state_blob.hpp"
#include "messages/messages.hpp"
#include "variables/variables.hpp"

namespace softffd::fmi {

struct Whole;  ///< all data of a state (state.cpp)

class Instance {
 public:
  Instance(SceneFile scene, Logger logger, Standard standard = Standard::fmi2);
  Instance(const Instance&) = delete;  // its parts refer to each other
  Instance& operator=(const Instance&) = delete;

  Phase phase = instantiated;
  Logger logger;

  /// Returns the instance to the state right after instantiation.
  void reset();
  void setup_experiment(double start_time, double tolerance, double stop_time);  ///< tolerance 0, stop_time infinite: not given
  void enter_initialization();
  void exit_initialization();
  fmi2Status do_step(double time, double step);

  void set(Type type, const fmi2ValueReference* references, std::size_t count, const double* values) {
    variables_.set(phase, type, references, count, values);
  }
  void get(Type type, const fmi2ValueReference* references, std::size_t count, double* values);
  void set_input_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, const double* values) {
    variables_.set_input_derivatives(references, count, orders, values);
  }
  void get_output_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, double* values) {
    variables_.get_output_derivatives(references, count, orders, values, body_, estimate());
  }

  std::vector<Variables::Array> arrays() const { return variables_.arrays(); }
  /// Returns the name of a variable (Variables::name).
  std::string name(fmi2ValueReference reference) const { return variables_.name(reference); }

  /// Returns all data that the instance needs to continue as it would have, as flat bytes.
  Bytes save_state() const;
  /// Continues from saved bytes. Throws StateError, and changes nothing, if the bytes are not a state of this scene.
  void load_state(const Bytes& bytes);
  const std::string& guid() const { return scene_.guid; }

  double last_successful_time() const { return times_.now; }

 private:
  Whole whole() const;
  const ErrorEstimate* estimate() const { return error_estimate_ ? &*error_estimate_ : nullptr; }
  void apply_values();
  void choose_tolerance();
  void ensure_initial_state();

  SceneFile scene_;
  SoftBody body_;
  Variables variables_;
  std::optional<ErrorEstimate> error_estimate_;  ///< only if the scene asks for it
  Messages messages_;
  Times times_;
};

}  // namespace softffd::fmi
