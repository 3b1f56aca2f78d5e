/// The 34 functions of FMI 2.0 for Co-Simulation. Each passes one guard: live handle, floating-point environment, the standard's table of
/// states, exceptions. What lies behind is in Instance.
#include <cmath>
#include <cstring>
#include <limits>
#include <new>

extern "C" {
#include "fmi2Functions.h"
}

#include "float_environment.hpp"
#include "instance.hpp"
#include "registry.hpp"
#include "resource_uri.hpp"

namespace softffd::fmi {

namespace {

constinit Registry<Instance> instances;

/// A state that a host holds: bytes, and the scene that they belong to.
struct SavedState {
  const Instance* owner;
  std::string guid;
  Bytes bytes;
};
constinit Registry<SavedState> states;

constexpr unsigned after_start = initializing | stepping | step_failed | terminated | failed;
constexpr unsigned settable = instantiated | initializing | stepping;
constexpr unsigned any_phase = instantiated | after_start;

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

fmi2Status fail(Instance& instance, std::string_view message) {
  instance.phase = failed;
  instance.logger.log(fmi2Error, log_error, message);
  return fmi2Error;
}

/// The one way into an instance. `call` returns a status; what it throws becomes fmi2Error with a message.
template <class Call>
fmi2Status guarded(fmi2Component component, const char* function, unsigned allowed, Call&& call) noexcept {
  const FloatEnvironment environment;
  try {
    Instance* instance = instances.live(component);
    if (!instance) return fmi2Error;
    try {
      if (!(instance->phase & allowed)) throw CallError(std::string(function) + ": not allowed " + phase_name(instance->phase));
      return call(*instance);
    } catch (const CallError& error) {
      return fail(*instance, error.what());
    } catch (const StateError& error) {  // foreign bytes refused: the instance is as it was
      instance->logger.log(fmi2Error, log_error, std::string(function) + ": " + error.what());
    } catch (const std::exception& error) {
      instance->phase = failed;
      return fail(*instance, std::string(function) + ": " + error.what());
    }
  } catch (...) {  // no memory for the message either
  }
  return fmi2Error;
}

void require(const void* pointer, std::size_t count, const char* function) {
  if (!pointer && count > 0) throw CallError(std::string(function) + ": got a null array for " + std::to_string(count) + " values");
}

fmi2Status unavailable(fmi2Component component, const char* function) noexcept {
  return guarded(component, function, any_phase, [&](Instance&) -> fmi2Status {
    throw CallError(std::string(function) + ": not available; modelDescription.xml does not claim it");
  });
}

fmi2Status no_variables(fmi2Component component, const char* function, unsigned allowed, const char* type, std::size_t count) noexcept {
  return guarded(component, function, allowed, [&](Instance&) -> fmi2Status {
    if (count > 0) throw CallError(std::string(function) + ": there are no " + type + " variables");
    return fmi2OK;
  });
}

const SavedState& saved(fmi2FMUstate handle) {
  const SavedState* state = states.live(handle);
  if (!state) throw StateError("FMUstate: wanted a state that fmi2GetFMUstate or fmi2DeSerializeFMUstate gave");
  return *state;
}

/// Puts bytes into the state behind *handle, or into a new one where *handle is null.
void keep(fmi2FMUstate* handle, SavedState state) {
  if (!*handle) {
    *handle = states.adopt(std::make_unique<SavedState>(std::move(state)));
    return;
  }
  saved(*handle);
  SavedState& place = *states.live(*handle);
  if (place.owner != state.owner) place.owner = state.owner;  // other instances read it when they are freed: not written without need
  place.guid = std::move(state.guid);
  place.bytes = std::move(state.bytes);
}

std::unique_ptr<Instance> instantiate(const Logger& logger, fmi2Type type, const char* guid, const char* resources) {
  if (type != fmi2CoSimulation) throw CallError("fmi2Instantiate: fmuType: wanted fmi2CoSimulation; model exchange is not available");
  if (!guid) throw CallError("fmi2Instantiate: fmuGUID: wanted a text, got null");
  if (!resources || !*resources)
    throw CallError("fmi2Instantiate: fmuResourceLocation: wanted the URI of the resources folder, got nothing");
  const auto path = path_from_uri(resources);
  if (!path) throw CallError(std::string("fmi2Instantiate: fmuResourceLocation: wanted a file: URI, got ") + resources);
  const bool slash = !path->empty() && path->back() == '/';
  SceneFile scene = read_scene(*path + (slash ? "scene.txt" : "/scene.txt"));
  if (scene.guid != guid) throw CallError("fmi2Instantiate: fmuGUID: wanted " + scene.guid + ", got " + guid);
  return std::make_unique<Instance>(std::move(scene), logger);
}

}  // namespace

}  // namespace softffd::fmi

using namespace softffd::fmi;

extern "C" {

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char* fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String instance_name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* callbacks, fmi2Boolean, fmi2Boolean logging_on) {
  const FloatEnvironment environment;
  if (!callbacks) return nullptr;
  try {
    const bool named = instance_name && *instance_name;
    const Logger logger(*callbacks, named ? instance_name : "", logging_on != fmi2False);
    try {
      if (!named) throw CallError("fmi2Instantiate: instanceName: wanted a text, got nothing");
      return instances.adopt(instantiate(logger, type, guid, resources));
    } catch (const std::exception& error) {
      logger.log(fmi2Error, log_error, error.what());
    }
  } catch (...) {  // no memory for the message either
  }
  return nullptr;
}

void fmi2FreeInstance(fmi2Component component) {
  const FloatEnvironment environment;
  states.release_if([&](const SavedState& state) { return state.owner == component; });
  instances.release(component);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count, const fmi2String categories[]) {
  return guarded(component, "fmi2SetDebugLogging", any_phase, [&](Instance& instance) {
    require(categories, count, "fmi2SetDebugLogging");
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) names.emplace_back(categories[i] ? categories[i] : "(null)");
    if (!instance.logger.switch_categories(on != fmi2False, names)) {
      const auto listed = [](const auto& words) {
        std::string text;
        for (const auto& word : words) text += (text.empty() ? "" : ", ") + std::string(word);
        return text;
      };
      throw CallError("fmi2SetDebugLogging: wanted categories of " + listed(log_categories) + ", got " + listed(names));
    }
    return fmi2OK;
  });
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_time,
                               fmi2Boolean stop_time_defined, fmi2Real stop_time) {
  return guarded(component, "fmi2SetupExperiment", instantiated, [&](Instance& instance) {
    if (!std::isfinite(start_time)) throw CallError("fmi2SetupExperiment: startTime: wanted a finite number, got " + number(start_time));
    if (tolerance_defined && !(std::isfinite(tolerance) && tolerance > 0))
      throw CallError("fmi2SetupExperiment: tolerance: wanted a finite number > 0, got " + number(tolerance));
    if (stop_time_defined && !(std::isfinite(stop_time) && stop_time > start_time))
      throw CallError("fmi2SetupExperiment: stopTime: wanted a finite number above startTime, got " + number(stop_time));
    instance.setup_experiment(start_time, tolerance_defined ? tolerance : 0,
                              stop_time_defined ? stop_time : std::numeric_limits<double>::infinity());
    return fmi2OK;
  });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return guarded(component, "fmi2EnterInitializationMode", instantiated, [](Instance& instance) {
    instance.enter_initialization();
    return fmi2OK;
  });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  return guarded(component, "fmi2ExitInitializationMode", initializing, [](Instance& instance) {
    instance.exit_initialization();
    return fmi2OK;
  });
}

fmi2Status fmi2Terminate(fmi2Component component) {
  return guarded(component, "fmi2Terminate", stepping | step_failed, [](Instance& instance) {
    instance.phase = terminated;
    return fmi2OK;
  });
}

fmi2Status fmi2Reset(fmi2Component component) {
  return guarded(component, "fmi2Reset", any_phase, [](Instance& instance) {
    instance.reset();
    return fmi2OK;
  });
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Real values[]) {
  return guarded(component, "fmi2GetReal", after_start, [&](Instance& instance) {
    require(references, count, "fmi2GetReal");
    require(values, count, "fmi2GetReal");
    instance.get(Type::Real, references, count, values);
    return fmi2OK;
  });
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count, const fmi2Real values[]) {
  return guarded(component, "fmi2SetReal", settable, [&](Instance& instance) {
    require(references, count, "fmi2SetReal");
    require(values, count, "fmi2SetReal");
    instance.set(Type::Real, references, count, values);
    return fmi2OK;
  });
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Integer values[]) {
  return guarded(component, "fmi2GetInteger", after_start, [&](Instance& instance) {
    require(references, count, "fmi2GetInteger");
    require(values, count, "fmi2GetInteger");
    std::vector<double> numbers(count);
    instance.get(Type::Integer, references, count, numbers.data());
    constexpr double most = std::numeric_limits<fmi2Integer>::max();
    for (std::size_t i = 0; i < count; ++i) values[i] = fmi2Integer(std::min(numbers[i], most));
    return fmi2OK;
  });
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count, const fmi2Integer values[]) {
  return guarded(component, "fmi2SetInteger", settable, [&](Instance& instance) {
    require(references, count, "fmi2SetInteger");
    require(values, count, "fmi2SetInteger");
    const std::vector<double> numbers(values, values + count);
    instance.set(Type::Integer, references, count, numbers.data());
    return fmi2OK;
  });
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference[], size_t count, fmi2Boolean[]) {
  return no_variables(component, "fmi2GetBoolean", after_start, "Boolean", count);
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference[], size_t count, const fmi2Boolean[]) {
  return no_variables(component, "fmi2SetBoolean", settable, "Boolean", count);
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference[], size_t count, fmi2String[]) {
  return no_variables(component, "fmi2GetString", after_start, "String", count);
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference[], size_t count, const fmi2String[]) {
  return no_variables(component, "fmi2SetString", settable, "String", count);
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real step, fmi2Boolean) {
  return guarded(component, "fmi2DoStep", stepping, [&](Instance& instance) { return instance.do_step(time, step); });
}

fmi2Status fmi2CancelStep(fmi2Component component) {
  return guarded(component, "fmi2CancelStep", 0, [](Instance&) { return fmi2Error; });  // steps are never pending
}

fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind, fmi2Status*) {
  return guarded(component, "fmi2GetStatus", stepping | step_failed | terminated, [](Instance& instance) {
    instance.logger.log(fmi2Discard, log_warning, "fmi2GetStatus: steps are never pending");
    return fmi2Discard;
  });
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real* value) {
  return guarded(component, "fmi2GetRealStatus", stepping | step_failed | terminated, [&](Instance& instance) {
    require(value, 1, "fmi2GetRealStatus");
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = instance.last_successful_time();
    return fmi2OK;
  });
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind, fmi2Integer*) {
  return guarded(component, "fmi2GetIntegerStatus", stepping | step_failed | terminated, [](Instance&) { return fmi2Discard; });
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean* value) {
  return guarded(component, "fmi2GetBooleanStatus", stepping | step_failed | terminated, [&](Instance&) {
    require(value, 1, "fmi2GetBooleanStatus");
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = fmi2False;  // the component never asks to end the simulation
    return fmi2OK;
  });
}

fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind, fmi2String*) {
  return guarded(component, "fmi2GetStringStatus", stepping | step_failed | terminated, [](Instance&) { return fmi2Discard; });
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return guarded(component, "fmi2GetFMUstate", any_phase, [&](Instance& instance) {
    require(state, 1, "fmi2GetFMUstate");
    keep(state, {&instance, instance.guid(), instance.save_state()});
    return fmi2OK;
  });
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return guarded(component, "fmi2SetFMUstate", any_phase, [&](Instance& instance) {
    const SavedState& wanted = saved(state);
    if (wanted.guid != instance.guid()) throw StateError("the state belongs to another scene");
    instance.load_state(wanted.bytes);
    return fmi2OK;
  });
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return guarded(component, "fmi2FreeFMUstate", any_phase, [&](Instance&) {
    if (!state || !*state) return fmi2OK;
    saved(*state);
    states.release(*state);
    *state = nullptr;
    return fmi2OK;
  });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t* size) {
  return guarded(component, "fmi2SerializedFMUstateSize", any_phase, [&](Instance&) {
    require(size, 1, "fmi2SerializedFMUstateSize");
    *size = head_size + saved(state).bytes.size();
    return fmi2OK;
  });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  return guarded(component, "fmi2SerializeFMUstate", any_phase, [&](Instance&) {
    require(bytes, size, "fmi2SerializeFMUstate");
    const SavedState& wanted = saved(state);
    const Bytes whole = with_head(wanted.guid, wanted.bytes);
    if (size < whole.size())
      throw CallError("fmi2SerializeFMUstate: size: wanted " + std::to_string(whole.size()) + " bytes, got " + std::to_string(size));
    std::memcpy(bytes, whole.data(), whole.size());
    return fmi2OK;
  });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
  return guarded(component, "fmi2DeSerializeFMUstate", any_phase, [&](Instance& instance) {
    require(bytes, size, "fmi2DeSerializeFMUstate");
    require(state, 1, "fmi2DeSerializeFMUstate");
    const std::span serialized(reinterpret_cast<const unsigned char*>(bytes), size);
    keep(state, {&instance, instance.guid(), without_head(instance.guid(), serialized)});
    return fmi2OK;
  });
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference[], size_t, const fmi2ValueReference[], size_t,
                                        const fmi2Real[], fmi2Real[]) {
  return unavailable(component, "fmi2GetDirectionalDerivative");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                       const fmi2Integer orders[], const fmi2Real values[]) {
  return guarded(component, "fmi2SetRealInputDerivatives", settable, [&](Instance& instance) {
    for (const void* array : {static_cast<const void*>(references), static_cast<const void*>(orders), static_cast<const void*>(values)})
      require(array, count, "fmi2SetRealInputDerivatives");
    instance.set_input_derivatives(references, count, orders, values);
    return fmi2OK;
  });
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                        const fmi2Integer orders[], fmi2Real values[]) {
  return guarded(component, "fmi2GetRealOutputDerivatives", stepping | step_failed | terminated | failed, [&](Instance& instance) {
    for (const void* array : {static_cast<const void*>(references), static_cast<const void*>(orders), static_cast<const void*>(values)})
      require(array, count, "fmi2GetRealOutputDerivatives");
    instance.get_output_derivatives(references, count, orders, values);
    return fmi2OK;
  });
}

}  // extern "C"
