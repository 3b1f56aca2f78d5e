/// What the files of vectorised loops share; included by them alone.
#pragma once

// One clone per instruction set where the loader can choose between them; elsewhere the baseline alone. Clang's choice needs a run-time
// library that not every toolchain built on it brings.
#if defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__) && !defined(__clang__) && !defined(SOFTFFD_NO_CLONES)
#define SOFTFFD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define SOFTFFD_CLONES
#endif

// The inner loops are functions of their own: only there does the compiler believe that the arrays do not overlap.
#define INNER static inline __attribute__((always_inline))

namespace softffd::kernels {
using In = const double* __restrict;
using Out = double* __restrict;
}  // namespace softffd::kernels
