/// The functions of FMI 2.0 for Co-Simulation that make, start, step, ask and free instances. standard_values.cpp and standard_states.cpp
/// have the others; what lies behind all of them is in Instance.
#include <cmath>
#include <limits>
#include <new>

extern "C" {
#include "fmi2Functions.h"
}

#include "calls/guard.hpp"
#include "calls/held_states.hpp"
#include "resource/resource_uri.hpp"

using namespace softffd::fmi;

namespace {

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

template <class Words>
std::string listed(const Words& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

}  // namespace

extern "C" {

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char* fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String instance_name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* callbacks, fmi2Boolean, fmi2Boolean logging_on) {
  const FloatEnvironment environment;
  if (!callbacks) return nullptr;
  try {
    const std::string name = instance_name ? instance_name : "";
    const Logger logger(*callbacks, name, logging_on != fmi2False);
    try {
      if (name.find_first_not_of(" \t\r\n\v\f") == name.npos)
        throw CallError(std::string("fmi2Instantiate: instanceName: wanted a text, got nothing") + (name.empty() ? "" : " but blanks"));
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
  release_all_of(component);
  instances.release(component);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count, const fmi2String categories[]) {
  return guarded(component, function::set_debug_logging, {{categories}, count}, [&](Instance& instance) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) names.emplace_back(categories[i] ? categories[i] : "(null)");
    const std::vector<std::string> unknown = instance.logger.switch_categories(on != fmi2False, names);
    if (unknown.empty()) return fmi2OK;
    return instance.logger.warn_caller("fmi2SetDebugLogging: wanted categories of " + listed(log_categories) + "; passed over " +
                                       listed(unknown));
  });
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_time,
                               fmi2Boolean stop_time_defined, fmi2Real stop_time) {
  return guarded(component, function::setup_experiment, {}, [&](Instance& instance) {
    if (!std::isfinite(start_time)) throw CallError("fmi2SetupExperiment: startTime: wanted a finite number, got " + number(start_time));
    if (tolerance_defined && !(std::isfinite(tolerance) && tolerance > 0))
      throw CallError("fmi2SetupExperiment: tolerance: wanted a finite number > 0, got " + number(tolerance));
    if (stop_time_defined && !(std::isfinite(stop_time) && stop_time > start_time))
      throw CallError("fmi2SetupExperiment: stopTime: wanted a finite number above startTime, got " + number(stop_time));
    instance.setup_experiment(start_time, tolerance_defined ? tolerance : 0,
                              stop_time_defined ? stop_time : std::numeric_limits<double>::infinity());
  });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return guarded(component, function::enter_initialization_mode, {}, [](Instance& instance) { instance.enter_initialization(); });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  return guarded(component, function::exit_initialization_mode, {}, [](Instance& instance) { instance.exit_initialization(); });
}

fmi2Status fmi2Terminate(fmi2Component component) {
  return guarded(component, function::terminate, {}, [](Instance& instance) { instance.phase = terminated; });
}

fmi2Status fmi2Reset(fmi2Component component) {
  return guarded(component, function::reset, {}, [](Instance& instance) { instance.reset(); });
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real step, fmi2Boolean) {
  return guarded(component, function::do_step, {}, [&](Instance& instance) { return instance.do_step(time, step); });
}

fmi2Status fmi2CancelStep(fmi2Component component) {
  return guarded(component, function::cancel_step, {}, [](Instance& instance) {
    return instance.logger.warn_caller("fmi2CancelStep: steps are never pending, there is none to cancel");
  });
}

fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind, fmi2Status*) {
  return guarded(component, function::get_status, {}, [](Instance& instance) {
    instance.logger.log(fmi2Discard, log_discard, "fmi2GetStatus: steps are never pending");
    return fmi2Discard;
  });
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real* value) {
  return guarded(component, function::get_real_status, {{value}}, [&](Instance& instance) {
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = instance.last_successful_time();
    return fmi2OK;
  });
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind, fmi2Integer*) {
  return guarded(component, function::get_integer_status, {}, [](Instance&) { return fmi2Discard; });
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean* value) {
  return guarded(component, function::get_boolean_status, {{value}}, [&](Instance&) {
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = fmi2False;  // the component never asks to end the simulation
    return fmi2OK;
  });
}

fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind, fmi2String*) {
  return guarded(component, function::get_string_status, {}, [](Instance&) { return fmi2Discard; });
}

}  // extern "C"
