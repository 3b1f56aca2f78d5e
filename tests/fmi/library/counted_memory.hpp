/// Counts a program's requests for memory and lets any of them fail; scenes and components to do that with.
///
/// With glibc the program's own malloc stands in front of the C library's, so every request is seen: operator
/// new, Eigen's buffers, the C library's own. Sanitizers bring a malloc of their own; there operator new
/// alone is seen. As it defines malloc, only one source of a program may include it.
#pragma once
#include <cstdlib>
#include <new>
#include <string>

extern "C" {
#include "fmi2Functions.h"
}

#include "check.hpp"
#include "small_scene.hpp"
#include "variable_table.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED 1
#endif
#endif

namespace memory {

inline long requests = 0;    ///< so far
inline long live = 0;        ///< blocks that are not freed
inline long countdown = -1;  ///< the request that fails, counted from 0; negative: none does
inline bool failed = false;  ///< a request has failed since `fail_at`

inline bool granted() {
  ++requests;
  if (countdown < 0 || countdown-- > 0) return true;
  failed = true;
  countdown = 0;  // so do all that follow
  return false;
}

template <class Request>
void* counted(Request&& request) {
  void* block = granted() ? request() : nullptr;
  live += block != nullptr;
  return block;
}

inline void fail_at(long request) {
  failed = false;
  countdown = request;
}
inline void fail_no_more() { countdown = -1; }

}  // namespace memory

#if defined(__GLIBC__) && !defined(SANITIZED)
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  return memory::counted([&] { return __libc_malloc(size); });
}
void* calloc(std::size_t count, std::size_t size) {
  return memory::counted([&] { return __libc_calloc(count, size); });
}
void* memalign(std::size_t alignment, std::size_t size) {
  return memory::counted([&] { return __libc_memalign(alignment, size); });
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = memalign(alignment, size);
  return *block ? 0 : 12;
}
void* realloc(void* block, std::size_t size) {
  if (!block) return malloc(size);
  return memory::granted() ? __libc_realloc(block, size) : nullptr;
}
void free(void* block) {
  memory::live -= block != nullptr;
  __libc_free(block);
}
}
#else
#define KEPT_WHOLE __attribute__((noinline))  // inlined, the pairs look mismatched to the compiler
KEPT_WHOLE void* operator new(std::size_t size) {
  void* block = memory::counted([&] { return std::malloc(size ? size : 1); });
  if (!block) throw std::bad_alloc();
  return block;
}
KEPT_WHOLE void* operator new[](std::size_t size) { return operator new(size); }
KEPT_WHOLE void operator delete(void* block) noexcept {
  memory::live -= block != nullptr;
  std::free(block);
}
KEPT_WHOLE void operator delete(void* block, std::size_t) noexcept { operator delete(block); }
KEPT_WHOLE void operator delete[](void* block) noexcept { operator delete(block); }
KEPT_WHOLE void operator delete[](void* block, std::size_t) noexcept { operator delete(block); }
#endif

namespace component {

using softffd::fmi::Family;

/// Writes a scene and returns the URI of its folder.
inline std::string resources(const std::string& parts, bool stiff = false, const std::string& spin = "0 0 0") {
  return (stiff ? small_scene::Box{.stiffness = 1e8, .initial = "1 1 1 0 0 0.001 0 0 0 " + spin} : small_scene::Box{}).resources(parts);
}

inline const std::string damped = "damping 0.05\n", heavy = "gravity 0 0 -9.81\n", watched = "energy\nsolver\nreactions\n";
inline const std::string planes = "plane ground fixed 0 0 0 0.1 0 1 0 0 0 0 0 0 0.4\nplane wall input 1.02 0 0 -1 0 0 0 0 0 0 0.1 0 0.2\n";
inline const std::string corner = "plane side fixed 0 -0.01 0 0 1 0 0 0 0 0 0 0 0.3\n";
inline const std::string pins = "pin base fixed 0 1\npin hand input 26\n";
inline const std::string driven = "load push 18 19 20\nforces 13 14\n";
inline const std::string regions = "region_stiffness 4000 0 1 2\nregion_damping 0.2 3 4\nprobe tip 0.5 0.5 0.9\nvelocities 0 13\n";
inline const std::string everything = damped + heavy + planes + pins + driven + regions + watched;

inline fmi2ValueReference reference(Family family, unsigned index = 0) { return unsigned(family) << 24 | index; }

inline void silent(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...) {}

inline fmi2Component instantiate(const std::string& uri, fmi2Boolean logging = fmi2False, const char* guid = "{g}") {
  const fmi2CallbackFunctions callbacks{silent, std::calloc, std::free, nullptr, nullptr};
  return fmi2Instantiate("box", fmi2CoSimulation, guid, uri.c_str(), &callbacks, fmi2False, logging);
}

inline fmi2Component started(const std::string& uri, int method = 1, fmi2Boolean logging = fmi2False) {
  fmi2Component c = instantiate(uri, logging);
  const fmi2ValueReference solver = reference(Family::solver_method);
  CHECK(fmi2SetInteger(c, &solver, 1, &method) == fmi2OK);
  CHECK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0) == fmi2OK);
  CHECK(fmi2EnterInitializationMode(c) == fmi2OK);
  CHECK(fmi2ExitInitializationMode(c) == fmi2OK);
  return c;
}

inline fmi2Status set(fmi2Component c, Family family, unsigned index, double value) {
  const fmi2ValueReference wanted = reference(family, index);
  return fmi2SetReal(c, &wanted, 1, &value);
}

}  // namespace component
