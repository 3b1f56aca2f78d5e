/// The objects that a host holds handles to: a handle that is not among them is refused without being looked into.
#pragma once
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <unordered_map>

namespace softffd::fmi {

template <class Object>
class Registry {
 public:
  /// Takes ownership; the pointer is the handle.
  Object* adopt(std::unique_ptr<Object> object) {
    Object* handle = object.get();
    const std::unique_lock lock(mutex_);
    objects_.emplace(handle, std::move(object));
    return handle;
  }
  /// The object behind a handle, or null.
  Object* live(const void* handle) const {
    const std::shared_lock lock(mutex_);
    const auto found = objects_.find(handle);
    return found == objects_.end() ? nullptr : found->second.get();
  }
  /// Destroys the object behind a handle; false for any other value.
  bool release(const void* handle) {
    std::unique_ptr<Object> last;
    const std::unique_lock lock(mutex_);
    const auto found = objects_.find(handle);
    if (found == objects_.end()) return false;
    last = std::move(found->second);
    objects_.erase(found);
    return true;
  }

 private:
  mutable std::shared_mutex mutex_;
  std::unordered_map<const void*, std::unique_ptr<Object>> objects_;
};

}  // namespace softffd::fmi
