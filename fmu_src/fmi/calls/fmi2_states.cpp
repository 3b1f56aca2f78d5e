/// The functions of FMI 2.0 that get, set and serialize FMU states.
extern "C" {
#include "fmi2Functions.h"
}

#include "calls/fmi2.hpp"
#include "calls/states.hpp"

using namespace softffd::fmi;

extern "C" {

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return guarded(component, function::get_state, {{{"FMUstate", state}}}, [&](Instance& instance) { get_state(instance, state); });
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return guarded(component, function::set_state, {}, [&](Instance& instance) { set_state(instance, state); });
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return guarded(component, function::free_state, {}, [&](Instance&) { free_state(state); });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t* size) {
  return guarded(component, function::state_size, {{{"size", size}}}, [&](Instance&) { *size = serialized_size(state); });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  return guarded(component, function::serialize, {{{"serializedState", bytes}}, size},
                 [&](Instance&) { named(function::serialize, [&] { serialize(state, bytes, size); }); });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
  return guarded(component, function::deserialize, {{{"serializedState", bytes}}, size}, [&](Instance& instance) {
    check_arrays(function::deserialize, {{{"FMUstate", state}}});
    deserialize(instance, bytes, size, state);
  });
}

}  // extern "C"
