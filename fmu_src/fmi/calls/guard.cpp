#include "calls/guard.hpp"

namespace softffd::fmi {

namespace {

const char* phase_name(Phase phase) {
  switch (phase) {
    case instantiated: return "instantiated";
    case initializing: return "in initialization mode";
    case stepping: return "ready for a step";
    case step_failed: return "after a discarded step";
    case terminated: return "terminated";
    case failed: return "in the error state";
  }
  return "in no known state";
}

}  // namespace

void check_phase(Phase phase, const Function& function) {
  if (!(phase & function.allowed)) throw CallError(std::string(function.name) + ": not allowed " + phase_name(phase));
}

void check_arrays(const Function& function, const Arrays& arrays) {
  for (const auto& [name, pointer] : arrays.arguments)
    if (!pointer && arrays.count > 0)
      throw CallError(std::string(function.name) + ": " + name + ": wanted " +
                      (arrays.count > 1 ? "an array of " + std::to_string(arrays.count) : std::string("a pointer")) + ", got null");
}

fmi2Status refused(Instance& instance, const Function& function) {
  const auto say = [&](std::string_view message) { instance.logger.log(fmi2Error, log_error, message); };
  try {
    throw;
  } catch (const CallError& error) {
    instance.phase = failed;
    say(error.what());
  } catch (const StateError& error) {  // the bytes are not a valid state: the instance is unchanged
    say(std::string(function.name) + ": " + error.what());
  } catch (const std::exception& error) {
    instance.phase = failed;
    say(std::string(function.name) + ": " + error.what());
  }
  return fmi2Error;
}

}  // namespace softffd::fmi
