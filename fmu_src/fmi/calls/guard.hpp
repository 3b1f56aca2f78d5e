/// The one way into an instance, for every function of both standards: floating-point environment, live handle, the standard's table of
/// states, null pointers, exceptions; in this order. fmi2.hpp and fmi3.hpp have the tables.
#pragma once
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>

#include "calls/float_environment.hpp"
#include "calls/registry.hpp"
#include "instance/instance.hpp"

namespace softffd::fmi {

/// A function as messages call it, and the states in which it may be called.
struct Function {
  const char* name;
  unsigned allowed;
};

/// States of which both tables are made.
namespace function {

inline constexpr unsigned after_start = initializing | stepping | step_failed | terminated | failed;
inline constexpr unsigned settable = instantiated | initializing | stepping;
inline constexpr unsigned any_phase = instantiated | after_start;
inline constexpr unsigned after_steps = stepping | step_failed | terminated;

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
  } catch (...) {  // no memory for the message either
  }
  return fmi2Error;
}

}  // namespace softffd::fmi
