/// FMU states, to which hosts of both standards hold handles: the operations on them, behind the guard.
#pragma once
#include "instance/instance.hpp"

namespace softffd::fmi {

using StateHandle = void*;  ///< the type in both standards

/// All throw StateError for an unknown handle or an unsuitable state; `serialize` throws CallError if `size` is too small.
void get_state(Instance& instance, StateHandle* state);  ///< into *state, or into a new state if *state is null
void set_state(Instance& instance, StateHandle state);
void free_state(StateHandle* state);
std::size_t serialized_size(StateHandle state);
void serialize(StateHandle state, void* bytes, std::size_t size);
void deserialize(Instance& instance, const void* bytes, std::size_t size, StateHandle* state);

/// Frees the states of an instance.
void free_states_of(const void* instance);

}  // namespace softffd::fmi
