/// FMU states that hosts hold handles to.
#pragma once
#include "instance/instance.hpp"

namespace softffd::fmi {

/// Bytes, the scene that they belong to, and the instance that they go with when it is freed.
struct HeldState {
  const void* owner;
  std::string guid;
  Bytes bytes;
};

/// The state behind a handle. Throws StateError.
std::shared_ptr<const HeldState> held(fmi2FMUstate handle);
/// Puts a state behind *handle, or behind a new one where *handle is null.
void hold(fmi2FMUstate* handle, HeldState state);
void release(fmi2FMUstate handle);
void release_all_of(const void* owner);

}  // namespace softffd::fmi
