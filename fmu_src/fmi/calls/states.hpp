/// FMU states that hosts of both standards hold handles to: what they ask of an instance about them, behind the guard.
#pragma once
#include "instance/instance.hpp"

namespace softffd::fmi {

using StateHandle = void*;  ///< of both standards

/// All throw StateError for what is no state of theirs.
void get_state(Instance& instance, StateHandle* state);  ///< behind *state, or behind a new handle where *state is null
void set_state(Instance& instance, StateHandle state);
void free_state(StateHandle* state);
std::size_t serialized_size(StateHandle state);
void serialize(StateHandle state, void* bytes, std::size_t size);
void deserialize(Instance& instance, const void* bytes, std::size_t size, StateHandle* state);

/// An instance's states go with it.
void free_states_of(const void* instance);

}  // namespace softffd::fmi
