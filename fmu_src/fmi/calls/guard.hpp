/// The one way into an instance, for every function of the standard: live handle, floating-point environment, the standard's table of
/// states, null pointers, exceptions; in this order.
#pragma once
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>

#include "calls/float_environment.hpp"
#include "calls/registry.hpp"
#include "instance/instance.hpp"

namespace softffd::fmi {

extern constinit Registry<Instance> instances;

/// A function as messages call it, and the states in which it may be called.
struct Function {
  const char* name;
  unsigned allowed;
};

/// What the standard lets a host call in which state (FMI 2.0.4, section 4.2.4).
namespace function {

inline constexpr unsigned after_start = initializing | stepping | step_failed | terminated | failed;
inline constexpr unsigned settable = instantiated | initializing | stepping;
inline constexpr unsigned any_phase = instantiated | after_start;
inline constexpr unsigned after_steps = stepping | step_failed | terminated;

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

/// Arrays of one length that a host hands over: none may be null where there is anything to read or write.
struct Arrays {
  std::initializer_list<const void*> pointers{};
  std::size_t count = 1;
};

/// Both throw CallError.
void check_phase(Phase phase, const Function& function);
void check_arrays(const Function& function, const Arrays& arrays);
/// The host's answer to an exception; it is that which is being handled.
fmi2Status refused(Instance& instance, const Function& function);

/// Calls call(), and has the message of what the host got wrong begin with the function's name.
template <class Call>
auto named(const Function& function, Call&& call) {
  try {
    return call();
  } catch (const CallError& error) {
    throw CallError(std::string(function.name) + ": " + error.what());
  }
}

/// Calls call(Held&), whose status, if it has one, is the host's; what it throws becomes fmi2Error with a message. Held: an Instance.
template <class Held, class Call>
fmi2Status guarded(Registry<Held>& registry, const void* handle, const Function& function, const Arrays& arrays, Call&& call) noexcept {
  const FloatEnvironment environment;
  try {
    Held* instance = registry.live(handle);
    if (!instance) return fmi2Error;
    try {
      check_phase(instance->phase, function);
      check_arrays(function, arrays);
      if constexpr (std::is_void_v<std::invoke_result_t<Call, Held&>>) {
        call(*instance);
        return fmi2OK;
      } else {
        return call(*instance);
      }
    } catch (...) {
      return refused(*instance, function);
    }
  } catch (...) {  // no memory for the message either
  }
  return fmi2Error;
}

template <class Call>
fmi2Status guarded(fmi2Component component, const Function& function, const Arrays& arrays, Call&& call) noexcept {
  return guarded(instances, component, function, arrays, std::forward<Call>(call));
}

}  // namespace softffd::fmi
