/// What hosts of both standards ask of an instance, behind the guard: its log categories, its experiment, its states.
#pragma once
#include "calls/guard.hpp"

namespace softffd::fmi {

fmi2Status switch_logging(Instance& instance, const Function& function, bool on, std::size_t count, const char* const* categories);

/// Start and, where they are given, tolerance and stop time [s]. Throws CallError.
struct Experiment {
  double start;
  const double* tolerance;  ///< null: not given
  const double* stop;
};
void set_up(Instance& instance, const Experiment& experiment);

using StateHandle = void*;  ///< of both standards

/// All throw StateError for what is no state of theirs.
void get_state(Instance& instance, StateHandle* state);
void set_state(Instance& instance, StateHandle state);
void free_state(StateHandle* state);
std::size_t serialized_size(StateHandle state);
void serialize(StateHandle state, void* bytes, std::size_t size);
void deserialize(Instance& instance, const void* bytes, std::size_t size, StateHandle* state);

}  // namespace softffd::fmi
