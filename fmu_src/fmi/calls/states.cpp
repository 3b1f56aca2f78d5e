#include "calls/states.hpp"

#include <cstring>
#include <span>

#include "calls/registry.hpp"

namespace softffd::fmi {

namespace {

/// The bytes of a state, the GUID of their scene, and the owner: the instance with which the state is freed.
struct HeldState {
  const void* owner;
  std::string guid;
  Bytes bytes;
};

constinit Registry<HeldState> states;

std::shared_ptr<HeldState> held(StateHandle handle) {
  std::shared_ptr<HeldState> state = states.live(handle);
  if (!state) throw StateError("FMUstate: wanted a state that was got or deserialized before");
  return state;
}

void hold(StateHandle* handle, HeldState state) {
  if (!*handle) {
    *handle = states.adopt(std::make_unique<HeldState>(std::move(state)));
    return;
  }
  const std::shared_ptr<HeldState> place = held(*handle);
  if (place->owner != state.owner) place->owner = state.owner;  // read by other instances when they are freed: not written needlessly
  place->guid = std::move(state.guid);
  place->bytes = std::move(state.bytes);
}

}  // namespace

void get_state(Instance& instance, StateHandle* state) { hold(state, {&instance, instance.guid(), instance.save_state()}); }

void set_state(Instance& instance, StateHandle state) {
  const auto wanted = held(state);
  if (wanted->guid != instance.guid()) throw StateError("the state belongs to another scene");
  instance.load_state(wanted->bytes);
}

void free_state(StateHandle* state) {
  if (!state || !*state) return;
  held(*state);
  states.release(*state);
  *state = nullptr;
}

std::size_t serialized_size(StateHandle state) {
  const auto wanted = held(state);
  return head_size(wanted->guid) + wanted->bytes.size();
}

void serialize(StateHandle state, void* bytes, std::size_t size) {
  const auto wanted = held(state);
  const Bytes whole = with_head(wanted->guid, wanted->bytes);
  if (size < whole.size()) throw CallError("size: wanted " + std::to_string(whole.size()) + " bytes, got " + std::to_string(size));
  std::memcpy(bytes, whole.data(), whole.size());
}

void deserialize(Instance& instance, const void* bytes, std::size_t size, StateHandle* state) {
  const std::span serialized(static_cast<const unsigned char*>(bytes), size);
  hold(state, {&instance, instance.guid(), without_head(instance.guid(), serialized)});
}

void free_states_of(const void* instance) {
  states.release_if([&](const HeldState& state) { return state.owner == instance; });
}

}  // namespace softffd::fmi
