/// Registry of the objects that a host holds handles to. A handle that is not in the registry is refused without being dereferenced.
///
/// The registry is trivially destructible on purpose: a library may be unloaded at any time, and not every toolchain runs destructors then.
/// The table is deleted together with the last object.
#pragma once
#include <atomic>
#include <memory>
#include <unordered_map>

namespace softffd::fmi {

template <class Object>
class Registry {
 public:
  /// Takes ownership of the object and returns its handle, which is the pointer.
  Object* adopt(std::unique_ptr<Object> object) {
    const Lock lock(busy_);
    if (!objects_) objects_ = new Table;
    Object* handle = object.get();
    try {
      objects_->emplace(handle, std::move(object));
    } catch (...) {
      drop_empty_table();
      throw;
    }
    return handle;
  }
  /// Returns the object of a handle, or null. The caller may use the object even if another thread releases it meanwhile.
  std::shared_ptr<Object> live(const void* handle) {
    const Lock lock(busy_);
    if (!objects_) return nullptr;
    const auto found = objects_->find(handle);
    return found == objects_->end() ? nullptr : found->second;
  }
  /// Destroys the object of a handle. Does nothing for any other value.
  void release(const void* handle) {
    std::shared_ptr<Object> last;  // destroyed after the lock is released
    const Lock lock(busy_);
    if (!objects_) return;
    const auto found = objects_->find(handle);
    if (found == objects_->end()) return;
    last = std::move(found->second);
    objects_->erase(found);
    drop_empty_table();
  }
  /// Destroys the objects for which the condition is true.
  template <class Condition>
  void release_if(Condition&& condition) {
    const Lock lock(busy_);
    if (!objects_) return;
    std::erase_if(*objects_, [&](const auto& entry) { return condition(*entry.second); });
    drop_empty_table();
  }

 private:
  using Table = std::unordered_map<const void*, std::shared_ptr<Object>>;

  /// Lock that is held only during a look-up. Waiting threads spin.
  class Lock {
   public:
    explicit Lock(std::atomic_flag& busy) : busy_(busy) {
      while (busy_.test_and_set(std::memory_order_acquire)) {
      }
    }
    ~Lock() { busy_.clear(std::memory_order_release); }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

   private:
    std::atomic_flag& busy_;
  };

  void drop_empty_table() {
    if (!objects_->empty()) return;
    delete objects_;
    objects_ = nullptr;
  }

  std::atomic_flag busy_;
  Table* objects_ = nullptr;
};

}  // namespace softffd::fmi
