/// The functions of FMI 2.0 for Co-Simulation that create, start, step, query and free instances. The other functions are in
/// fmi2_values.cpp and fmi2_states.cpp. Instance implements what all of them do.
extern "C" {
#include "fmi2Functions.h"
}

#include "calls/fmi2.hpp"
#include "calls/opening.hpp"
#include "calls/requests.hpp"
#include "calls/states.hpp"
#include "resource/resource_uri.hpp"

using namespace softffd::fmi;

namespace softffd::fmi {

constinit Registry<Instance> instances;

}  // namespace softffd::fmi

namespace {

SceneFile scene_of(fmi2Type type, const char* resources, const Asked& asked) {
  if (type != fmi2CoSimulation) throw CallError("fmuType: wanted fmi2CoSimulation; model exchange is not available");
  if (!resources || !*resources) throw CallError("fmuResourceLocation: wanted the URI of the resources folder, got nothing");
  return scene_in(path_from_uri(resources), asked);
}

}  // namespace

extern "C" {

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char* fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String instance_name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* callbacks, fmi2Boolean, fmi2Boolean logging_on) {
  if (!callbacks) return nullptr;
  const Asked asked{instance_name, "fmuGUID", guid};
  return instantiate(
      instances, "fmi2Instantiate", asked, [&] { return Logger(*callbacks, instance_name ? instance_name : "", logging_on != fmi2False); },
      [&] { return scene_of(type, resources, asked); });
}

void fmi2FreeInstance(fmi2Component component) {
  const FloatEnvironment environment;
  free_states_of(component);
  instances.release(component);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count, const fmi2String categories[]) {
  return guarded(component, function::set_debug_logging, {{{"categories", categories}}, count}, [&](Instance& instance) {
    return switch_logging(instance, function::set_debug_logging, on != fmi2False, count, categories);
  });
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_time,
                               fmi2Boolean stop_time_defined, fmi2Real stop_time) {
  return guarded(component, function::setup_experiment, {}, [&](Instance& instance) {
    const Experiment wanted{start_time, tolerance_defined ? &tolerance : nullptr, stop_time_defined ? &stop_time : nullptr};
    named(function::setup_experiment, [&] { set_up(instance, wanted); });
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
  return guarded(component, function::do_step, {},
                 [&](Instance& instance) { return named(function::do_step, [&] { return instance.do_step(time, step); }); });
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
  return guarded(component, function::get_real_status, {{{"value", value}}}, [&](Instance& instance) {
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = instance.last_successful_time();
    return fmi2OK;
  });
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind, fmi2Integer*) {
  return guarded(component, function::get_integer_status, {}, [](Instance&) { return fmi2Discard; });
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean* value) {
  return guarded(component, function::get_boolean_status, {{{"value", value}}}, [&](Instance&) {
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = fmi2False;  // the component never requests the end of the simulation
    return fmi2OK;
  });
}

fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind, fmi2String*) {
  return guarded(component, function::get_string_status, {}, [](Instance&) { return fmi2Discard; });
}

}  // extern "C"
