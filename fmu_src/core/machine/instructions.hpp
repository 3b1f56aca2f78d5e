/// Loops compiled for several instruction sets, of which the processor's own runs: chosen when the library is loaded, the same way with
/// every compiler. Included by the files of vectorised loops alone.
#pragma once

// The inner loops are functions of their own: only there does the compiler believe that the arrays do not overlap. They are inlined into a
// function for each instruction set.
#define INLINED __attribute__((always_inline))
#define INNER static inline INLINED

#if defined(__x86_64__)
#include <cpuid.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#endif

namespace softffd::kernels {

using In = const double* __restrict;
using Out = double* __restrict;

#if defined(__x86_64__)

enum class Instructions { baseline, avx2, avx512 };

/// What processor and system allow. Asked here, because what compilers offer for it is not in every toolchain's run-time library.
inline Instructions allowed() {
  unsigned a = 0, b = 0, c = 0, d = 0, saved = 0, above = 0;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE)) return Instructions::baseline;
  __asm__("xgetbv" : "=a"(saved), "=d"(above) : "c"(0));  // the registers that the system keeps for each thread
  const unsigned middle = 0x06, wide = 0xe6;
  if ((saved & middle) != middle || !__get_cpuid_count(7, 0, &a, &b, &c, &d) || !(b & bit_AVX2)) return Instructions::baseline;
  return (saved & wide) == wide && (b & bit_AVX512F) ? Instructions::avx512 : Instructions::avx2;
}

/// The widest, and at most what the environment variable SOFTFFD_INSTRUCTIONS names: "baseline" or "avx2".
inline Instructions instructions() {
  static const Instructions widest = [] {
    const char* named = std::getenv("SOFTFFD_INSTRUCTIONS");
    const auto is = [&](const char* name) { return named && std::strcmp(named, name) == 0; };
    const Instructions most = is("baseline") ? Instructions::baseline : is("avx2") ? Instructions::avx2 : Instructions::avx512;
    return std::min(most, allowed());
  }();
  return widest;
}

template <auto loop>
struct Compiled;

template <class Result, class... A, Result (*loop)(A...)>
struct Compiled<loop> {
  static Result baseline(A... a) { return loop(a...); }
  __attribute__((target("avx2"))) static Result avx2(A... a) { return loop(a...); }
  __attribute__((target("avx512f"))) static Result avx512(A... a) { return loop(a...); }
};

/// The loop for this processor; for wider instruction sets it may be another one.
template <auto loop, auto avx2 = loop, auto avx512 = avx2>
auto chosen() {
  switch (instructions()) {
    case Instructions::baseline: return Compiled<loop>::baseline;
    case Instructions::avx2: return Compiled<avx2>::avx2;
    case Instructions::avx512: break;
  }
  return Compiled<avx512>::avx512;
}

#else

template <auto loop, auto...>
auto chosen() {
  return loop;
}

#endif

}  // namespace softffd::kernels
