/// The instances that exist: a handle that is not among them is refused without being looked into.
#pragma once
#include <memory>

#include "instance.hpp"

namespace softffd::fmi {

/// Takes ownership; the pointer is the handle.
Instance* adopt(std::unique_ptr<Instance> instance);
/// The instance behind a handle, or null.
Instance* live(const void* handle);
/// Destroys the instance behind a handle; nothing happens for any other value.
void release(const void* handle);

}  // namespace softffd::fmi
