/// The part of the guard for FMI 2.0: its instances, and the states in which a host may call each function.
#pragma once
#include "calls/guard.hpp"

namespace softffd::fmi {

extern constinit Registry<Instance> instances;

template <class Call>
fmi2Status guarded(fmi2Component component, const Function& function, const Arrays& arrays, Call&& call) noexcept {
  return guarded(instances, component, function, arrays, std::forward<Call>(call));
}

/// The states in which the standard lets a host call each function (FMI 2.0.4, section 4.2.4).
namespace function {

inline constexpr Function set_debug_logging{"fmi2SetDebugLogging", any_phase};
inline constexpr Function setup_experiment{"fmi2SetupExperiment", instantiated};
inline constexpr Function enter_initialization_mode{"fmi2EnterInitializationMode", instantiated};
inline constexpr Function exit_initialization_mode{"fmi2ExitInitializationMode", initializing};
inline constexpr Function terminate{"fmi2Terminate", stepping | step_failed};
inline constexpr Function reset{"fmi2Reset", any_phase};
inline constexpr Function get_real{"fmi2GetReal", after_start};
inline constexpr Function get_integer{"fmi2GetInteger", after_start};
inline constexpr Function get_boolean{"fmi2GetBoolean", after_start};
inline constexpr Function get_string{"fmi2GetString", after_start};
inline constexpr Function set_real{"fmi2SetReal", settable};
inline constexpr Function set_integer{"fmi2SetInteger", settable};
inline constexpr Function set_boolean{"fmi2SetBoolean", settable};
inline constexpr Function set_string{"fmi2SetString", settable};
inline constexpr Function get_state{"fmi2GetFMUstate", any_phase};
inline constexpr Function set_state{"fmi2SetFMUstate", any_phase};
inline constexpr Function free_state{"fmi2FreeFMUstate", any_phase};
inline constexpr Function state_size{"fmi2SerializedFMUstateSize", any_phase};
inline constexpr Function serialize{"fmi2SerializeFMUstate", any_phase};
inline constexpr Function deserialize{"fmi2DeSerializeFMUstate", any_phase};
inline constexpr Function directional_derivative{"fmi2GetDirectionalDerivative", any_phase};
inline constexpr Function set_input_derivatives{"fmi2SetRealInputDerivatives", settable};
inline constexpr Function get_output_derivatives{"fmi2GetRealOutputDerivatives", after_steps | failed};
inline constexpr Function do_step{"fmi2DoStep", stepping};
inline constexpr Function cancel_step{"fmi2CancelStep", any_phase & ~unsigned{failed}};  // there is nothing to do
inline constexpr Function get_status{"fmi2GetStatus", after_steps};
inline constexpr Function get_real_status{"fmi2GetRealStatus", after_steps};
inline constexpr Function get_integer_status{"fmi2GetIntegerStatus", after_steps};
inline constexpr Function get_boolean_status{"fmi2GetBooleanStatus", after_steps};
inline constexpr Function get_string_status{"fmi2GetStringStatus", after_steps};

}  // namespace function

}  // namespace softffd::fmi
