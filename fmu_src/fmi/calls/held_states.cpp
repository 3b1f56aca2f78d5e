#include "calls/held_states.hpp"

#include "calls/registry.hpp"

namespace softffd::fmi {

namespace {

constinit Registry<HeldState> states;

std::shared_ptr<HeldState> live(fmi2FMUstate handle) {
  std::shared_ptr<HeldState> state = states.live(handle);
  if (!state) throw StateError("FMUstate: wanted a state that was got or deserialized before");
  return state;
}

}  // namespace

std::shared_ptr<const HeldState> held(fmi2FMUstate handle) { return live(handle); }

void hold(fmi2FMUstate* handle, HeldState state) {
  if (!*handle) {
    *handle = states.adopt(std::make_unique<HeldState>(std::move(state)));
    return;
  }
  const std::shared_ptr<HeldState> place = live(*handle);
  if (place->owner != state.owner) place->owner = state.owner;  // other instances read it when they are freed: not written without need
  place->guid = std::move(state.guid);
  place->bytes = std::move(state.bytes);
}

void release(fmi2FMUstate handle) { states.release(handle); }

void release_all_of(const void* owner) {
  states.release_if([&](const HeldState& state) { return state.owner == owner; });
}

}  // namespace softffd::fmi
