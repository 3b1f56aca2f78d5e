/// The guard through which every function of both standards accesses an instance. It handles, in this order: floating-point environment,
/// live handle, the standard's table of allowed states, null pointers, exceptions. The tables are in fmi2.hpp and fmi3.hpp.
#pragma once
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>

#include "calls/float_environment.hpp"
#include "calls/registry.hpp"
#include "instance/instance.hpp"

namespace softffd::fmi {

/// A function: its name in messages, and the states in which it may be called.
struct Function {
  const char* name;
  unsigned allowed;
};

/// Sets of states that both tables use.
namespace function {

inline constexpr unsigned after_start = initializing | stepping | step_failed | terminated | failed;
inline constexpr unsigned settable = instantiated | initializing | stepping;
inline constexpr unsigned any_phase = instantiated | after_start;
inline constexpr unsigned after_steps = stepping | step_failed | terminated;

}  // namespace function

/// Arrays of the same length that a host passes, with the standard's names. None may be null if `count` > 0.
struct Argument {
  const char* name;
  const void* pointer;
};
struct Arrays {
  std::initializer_list<Argument> arguments{};
  std::size_t count = 1;
};

/// Check that the function is allowed in this phase, and that no array is null. Both throw CallError.
void check_phase(Phase phase, const Function& function);
void check_arrays(const Function& function, const Arrays& arrays);
/// Logs the exception that is being handled and returns fmi2Error. The instance enters the error state, except after a StateError.
fmi2Status refused(Instance& instance, const Function& function);

/// Calls call(). If it throws CallError, the function's name is put in front of the message.
template <class Call>
auto named(const Function& function, Call&& call) {
  try {
    return call();
  } catch (const CallError& error) {
    throw CallError(std::string(function.name) + ": " + error.what());
  }
}

/// Calls call(Held&) and returns its status, or fmi2OK if it returns void. An exception becomes fmi2Error with a message. Held: Instance or
/// a class derived from it.
template <class Held, class Call>
fmi2Status guarded(Registry<Held>& registry, const void* handle, const Function& function, const Arrays& arrays, Call&& call) noexcept {
  const FloatEnvironment environment;
  try {
    const std::shared_ptr<Held> instance = registry.live(handle);
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
  } catch (...) {  // there is no memory even for the message
  }
  return fmi2Error;
}

}  // namespace softffd::fmi
