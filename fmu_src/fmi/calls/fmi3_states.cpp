/// The functions of FMI 3.0 that get, set and serialize FMU states.
extern "C" {
#include "fmi3Functions.h"
}

#include "calls/fmi3.hpp"
#include "calls/states.hpp"

using namespace softffd::fmi;

extern "C" {

fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState* state) {
  return guarded3(handle, function3::get_state, {{{"FMUState", state}}}, [&](Instance& instance) { get_state(instance, state); });
}

fmi3Status fmi3SetFMUState(fmi3Instance handle, fmi3FMUState state) {
  return guarded3(handle, function3::set_state, {}, [&](Instance& instance) { set_state(instance, state); });
}

fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState* state) {
  return guarded3(handle, function3::free_state, {}, [&](Instance&) { free_state(state); });
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance handle, fmi3FMUState state, size_t* size) {
  return guarded3(handle, function3::state_size, {{{"size", size}}}, [&](Instance&) { *size = serialized_size(state); });
}

fmi3Status fmi3SerializeFMUState(fmi3Instance handle, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  return guarded3(handle, function3::serialize, {{{"serializedState", bytes}}, size},
                  [&](Instance&) { named(function3::serialize, [&] { serialize(state, bytes, size); }); });
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance handle, const fmi3Byte bytes[], size_t size, fmi3FMUState* state) {
  return guarded3(handle, function3::deserialize, {{{"serializedState", bytes}}, size}, [&](Instance& instance) {
    check_arrays(function3::deserialize, {{{"FMUState", state}}});
    deserialize(instance, bytes, size, state);
  });
}

}  // extern "C"
