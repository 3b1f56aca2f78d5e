/// The functions of FMI 2.0 that get, set and serialize FMU states.
#include <cstring>

extern "C" {
#include "fmi2Functions.h"
}

#include "calls/guard.hpp"
#include "calls/held_states.hpp"

using namespace softffd::fmi;

extern "C" {

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return guarded(component, function::get_state, {{state}},
                 [&](Instance& instance) { hold(state, {&instance, instance.guid(), instance.save_state()}); });
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return guarded(component, function::set_state, {}, [&](Instance& instance) {
    const HeldState& wanted = held(state);
    if (wanted.guid != instance.guid()) throw StateError("the state belongs to another scene");
    instance.load_state(wanted.bytes);
  });
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return guarded(component, function::free_state, {}, [&](Instance&) {
    if (!state || !*state) return;
    held(*state);
    release(*state);
    *state = nullptr;
  });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t* size) {
  return guarded(component, function::state_size, {{size}}, [&](Instance&) { *size = head_size + held(state).bytes.size(); });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  return guarded(component, function::serialize, {{bytes}, size}, [&](Instance&) {
    const HeldState& wanted = held(state);
    const Bytes whole = with_head(wanted.guid, wanted.bytes);
    if (size < whole.size())
      throw CallError("fmi2SerializeFMUstate: size: wanted " + std::to_string(whole.size()) + " bytes, got " + std::to_string(size));
    std::memcpy(bytes, whole.data(), whole.size());
  });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
  return guarded(component, function::deserialize, {{bytes}, size}, [&](Instance& instance) {
    check_arrays(function::deserialize, {{state}});
    const std::span serialized(reinterpret_cast<const unsigned char*>(bytes), size);
    hold(state, {&instance, instance.guid(), without_head(instance.guid(), serialized)});
  });
}

}  // extern "C"
