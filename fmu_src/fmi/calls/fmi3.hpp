/// The part of the guard for FMI 3.0: its instances, and the states in which a host may call each function.
#pragma once
#include "calls/guard.hpp"
#include "instance/array_instance.hpp"

namespace softffd::fmi {

static_assert(int(fmi2OK) == int(fmi3OK) && int(fmi2Warning) == int(fmi3Warning) && int(fmi2Discard) == int(fmi3Discard) &&
              int(fmi2Error) == int(fmi3Error) && int(fmi2Fatal) == int(fmi3Fatal));

extern constinit Registry<ArrayInstance> array_instances;

template <class Call>
fmi3Status guarded3(fmi3Instance instance, const Function& function, const Arrays& arrays, Call&& call) noexcept {
  return fmi3Status(guarded(array_instances, instance, function, arrays, std::forward<Call>(call)));
}

/// The states in which the standard lets a host call each function (FMI 3.0.2, sections 2.3 and 4.2). After an error a host may read
/// values, save the state and reset.
namespace function3 {

inline constexpr unsigned any_phase = function::any_phase, settable = function::settable;

inline constexpr Function set_debug_logging{"fmi3SetDebugLogging", any_phase};
inline constexpr Function enter_initialization_mode{"fmi3EnterInitializationMode", instantiated};
inline constexpr Function exit_initialization_mode{"fmi3ExitInitializationMode", initializing};
inline constexpr Function terminate{"fmi3Terminate", stepping};
inline constexpr Function reset{"fmi3Reset", any_phase};
inline constexpr Function do_step{"fmi3DoStep", stepping};
inline constexpr Function get_float64{"fmi3GetFloat64", any_phase};
inline constexpr Function set_float64{"fmi3SetFloat64", settable};
inline constexpr Function get_int64{"fmi3GetInt64", any_phase};
inline constexpr Function set_int64{"fmi3SetInt64", settable};
inline constexpr Function get_output_derivatives{"fmi3GetOutputDerivatives", stepping | terminated | failed};
inline constexpr Function get_state{"fmi3GetFMUState", any_phase};
inline constexpr Function set_state{"fmi3SetFMUState", any_phase};
inline constexpr Function free_state{"fmi3FreeFMUState", any_phase};
inline constexpr Function state_size{"fmi3SerializedFMUStateSize", any_phase};
inline constexpr Function serialize{"fmi3SerializeFMUState", any_phase};
inline constexpr Function deserialize{"fmi3DeserializeFMUState", any_phase};

}  // namespace function3

}  // namespace softffd::fmi
