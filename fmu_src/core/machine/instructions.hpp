/// Compiles loops for several instruction sets. The version for the processor at hand is chosen when the library is loaded, in the same
/// way with every compiler. Included only by files with vectorised loops.
#pragma once

// The inner loops are functions of their own, because only there does the compiler believe that the arrays do not overlap. The functions
// are inlined into one function for each instruction set.
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

/// Returns the instruction set that processor and system allow. The processor is asked directly, because the functions that compilers
/// offer for this are not in the run-time library of every toolchain.
inline Instructions allowed() {
  unsigned a = 0, b = 0, c = 0, d = 0, saved = 0, above = 0;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE)) return Instructions::baseline;
  __asm__("xgetbv" : "=a"(saved), "=d"(above) : "c"(0));  // the registers that the system saves for each thread
  const unsigned middle = 0x06, wide = 0xe6;
  if ((saved & middle) != middle || !__get_cpuid_count(7, 0, &a, &b, &c, &d) || !(b & bit_AVX2)) return Instructions::baseline;
  return (saved & wide) == wide && (b & bit_AVX512F) ? Instructions::avx512 : Instructions::avx2;
}

/// Returns the widest instruction set allowed, at most that in the environment variable SOFTFFD_INSTRUCTIONS: "baseline" or "avx2".
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

/// Returns the loop compiled for this processor. The wider instruction sets may have another loop.
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
