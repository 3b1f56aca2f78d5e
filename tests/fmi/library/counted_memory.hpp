/// Counts a program's requests for memory and lets any of them fail.
///
/// With glibc the program's own malloc stands in front of the C library's, so every request is seen: operator
/// new, Eigen's buffers, the C library's own. Sanitizers bring a malloc of their own; there operator new
/// alone is seen. As it defines malloc, only one source of a program may include it.
#pragma once
#include <cstdlib>
#include <functional>
#include <new>

#include "host.hpp"

#if defined(__unix__)
#include <sys/wait.h>
#include <unistd.h>
#endif

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

namespace memory {

/// Calls attempt(failing) again and again; of what is called by `failing` in it the first, second, ... request fails, until it needs no
/// more. Nothing may be left behind.
template <class Attempt>
void each_request_fails(const char* what, Attempt&& attempt) {
  const int failures = check::failures;
  for (long request = 0; check::failures <= failures + 20; ++request) {
    const long before = live;
    attempt([request](auto&& call) {
      fail_at(request);
      const auto result = call();
      fail_no_more();
      return result;
    });
    if (live != before) std::printf("    %s: request %ld leaves %ld blocks\n", what, request, live - before);
    CHECK(live == before);
    if (!failed) return;
  }
}

/// What a block returns that runs in a process of its own, so that a crash is a failed check and not the end of the program; false then.
inline bool survived(const char* what, const std::function<bool()>& block) {
#if defined(__unix__)
  constexpr int failed_checks = 1, said_yes = 42;
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    const int before = check::failures;
    const bool said = block();
    std::fflush(nullptr);
    _exit(check::failures > before ? failed_checks : said ? said_yes : 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  const bool said = WIFEXITED(status) && WEXITSTATUS(status) == said_yes, well = said || (WIFEXITED(status) && WEXITSTATUS(status) == 0);
  if (!well) std::printf("    %s: the process ended with status %d\n", what, status);
  CHECK(well);
  return said;
#else
  return block();
#endif
}

}  // namespace memory
