#include "live_instances.hpp"

#include <mutex>
#include <shared_mutex>
#include <unordered_map>

namespace softffd::fmi {

namespace {

std::shared_mutex mutex;
std::unordered_map<const void*, std::unique_ptr<Instance>> instances;

}  // namespace

Instance* adopt(std::unique_ptr<Instance> instance) {
  Instance* handle = instance.get();
  const std::unique_lock lock(mutex);
  instances.emplace(handle, std::move(instance));
  return handle;
}

Instance* live(const void* handle) {
  const std::shared_lock lock(mutex);
  const auto found = instances.find(handle);
  return found == instances.end() ? nullptr : found->second.get();
}

void release(const void* handle) {
  std::unique_ptr<Instance> last;
  const std::unique_lock lock(mutex);
  const auto found = instances.find(handle);
  if (found == instances.end()) return;
  last = std::move(found->second);
  instances.erase(found);
}

}  // namespace softffd::fmi
