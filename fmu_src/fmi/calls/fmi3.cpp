/// The functions of FMI 3.0 for Co-Simulation that create, start, step and free instances. The other functions are in fmi3_values.cpp and
/// fmi3_states.cpp, and the functions that are not implemented are in fmi3_absent.cpp.
extern "C" {
#include "fmi3Functions.h"
}

#include "calls/fmi3.hpp"
#include "calls/opening.hpp"
#include "calls/requests.hpp"
#include "calls/states.hpp"

using namespace softffd::fmi;

namespace softffd::fmi {

constinit Registry<ArrayInstance> array_instances;

}  // namespace softffd::fmi

namespace {

Logger logger_of(fmi3InstanceEnvironment environment, fmi3LogMessageCallback callback, bool logging_on) {
  Logger::Host host;
  if (callback)
    host = [=](fmi2Status status, const char* category, const char* message) {
      callback(environment, fmi3Status(status), category, message);
    };
  std::vector<std::string_view> declared(std::begin(log_categories), std::end(log_categories));
  std::erase(declared, log_pending);  // FMI 3.0 has no steps that are pending
  return {std::move(host), "#", std::move(declared), logging_on};
}

struct Modes {
  bool events;
  std::size_t intermediate_variables;
};

SceneFile scene_of(const Modes& modes, const char* resources, const Asked& asked) {
  if (modes.events) throw CallError("eventModeUsed: wanted fmi3False; modelDescription.xml claims no event mode");
  if (modes.intermediate_variables > 0)
    throw CallError("nRequiredIntermediateVariables: wanted 0, got " + std::to_string(modes.intermediate_variables) +
                    "; modelDescription.xml claims no intermediate update");
  if (!resources || !*resources) throw CallError("resourcePath: wanted the path of the resources folder, got nothing");
  if (std::string_view(resources).starts_with("file:"))
    throw CallError(std::string("resourcePath: wanted a path, without file:, got the URI ") + resources);
  return scene_in(resources, asked);
}

}  // namespace

extern "C" {

const char* fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instance_name, fmi3String token, fmi3String resources, fmi3Boolean,
                                         fmi3Boolean logging_on, fmi3Boolean event_mode_used, fmi3Boolean, const fmi3ValueReference[],
                                         size_t intermediate_variables, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log_message, fmi3IntermediateUpdateCallback) {
  const Asked asked{instance_name, "instantiationToken", token};
  return instantiate(
      array_instances, "fmi3InstantiateCoSimulation", asked, [&] { return logger_of(environment, log_message, logging_on); },
      [&] { return scene_of({event_mode_used, intermediate_variables}, resources, asked); });
}

void fmi3FreeInstance(fmi3Instance instance) {
  const FloatEnvironment environment;
  free_states_of(instance);
  array_instances.release(instance);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance handle, fmi3Boolean on, size_t count, const fmi3String categories[]) {
  return guarded3(handle, function3::set_debug_logging, {{{"categories", categories}}, count},
                  [&](Instance& instance) { return switch_logging(instance, function3::set_debug_logging, on, count, categories); });
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance handle, fmi3Boolean tolerance_defined, fmi3Float64 tolerance, fmi3Float64 start_time,
                                       fmi3Boolean stop_time_defined, fmi3Float64 stop_time) {
  return guarded3(handle, function3::enter_initialization_mode, {}, [&](Instance& instance) {
    const Experiment wanted{start_time, tolerance_defined ? &tolerance : nullptr, stop_time_defined ? &stop_time : nullptr};
    named(function3::enter_initialization_mode, [&] { set_up(instance, wanted); });
    instance.enter_initialization();
  });
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance handle) {
  return guarded3(handle, function3::exit_initialization_mode, {}, [](Instance& instance) { instance.exit_initialization(); });
}

fmi3Status fmi3Terminate(fmi3Instance handle) {
  return guarded3(handle, function3::terminate, {}, [](Instance& instance) { instance.phase = terminated; });
}

fmi3Status fmi3Reset(fmi3Instance handle) {
  return guarded3(handle, function3::reset, {}, [](Instance& instance) { instance.reset(); });
}

fmi3Status fmi3DoStep(fmi3Instance handle, fmi3Float64 time, fmi3Float64 step, fmi3Boolean, fmi3Boolean* event_handling_needed,
                      fmi3Boolean* terminate_simulation, fmi3Boolean* early_return, fmi3Float64* last_successful_time) {
  const Arrays results{{{"eventHandlingNeeded", event_handling_needed},
                        {"terminateSimulation", terminate_simulation},
                        {"earlyReturn", early_return},
                        {"lastSuccessfulTime", last_successful_time}}};
  return guarded3(handle, function3::do_step, results, [&](Instance& instance) {
    *event_handling_needed = *terminate_simulation = *early_return = fmi3False;
    *last_successful_time = instance.last_successful_time();
    const fmi2Status status = named(function3::do_step, [&] { return instance.do_step(time, step); });
    *last_successful_time = instance.last_successful_time();
    if (status == fmi2Discard) instance.phase = stepping;  // FMI 3.0 has no state for a discarded step: the step may be repeated
    return status;
  });
}

}  // extern "C"
