/// As many numbers as a register holds (lanes), in the compiler's own vector type. No operation mixes lanes, so the bits of the results
/// do not depend on the number of lanes. Included only by files with vectorised loops.
#pragma once
#include <cmath>
#include <cstring>

#include "machine/instructions.hpp"

#pragma GCC diagnostic ignored "-Wpsabi"  // about passing such vectors between functions, which are all inline here

namespace softffd::kernels {

template <int n>
struct Register {
  typedef double Lanes __attribute__((vector_size(8 * n)));
};
template <int n>
using Lanes = typename Register<n>::Lanes;

template <int n>
INNER Lanes<n> load(const double* from) {
  Lanes<n> v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

template <int n>
INNER void store(double* x, const Lanes<n>& v) {
  std::memcpy(x, &v, sizeof v);
}

template <int n>
INNER Lanes<n> square_root(const Lanes<n>& v) {
#if defined(__has_builtin) && __has_builtin(__builtin_elementwise_sqrt)
  return __builtin_elementwise_sqrt(v);
#else
  Lanes<n> root;
  for (int i = 0; i < n; ++i) root[i] = std::sqrt(v[i]);
  return root;
#endif
}

/// Result of a comparison: -1 (true) or 0 (false) in each lane.
template <int n>
using Comparison = decltype(Lanes<n>{} < Lanes<n>{});

/// Returns the bits of all lanes combined by `or`.
template <int n>
INNER unsigned joined(const Comparison<n>& lanes) {
  if constexpr (n == 1) {
    return unsigned(lanes[0]);
  } else {
    Comparison<n / 2> half[2];
    std::memcpy(half, &lanes, sizeof half);
    return joined<n / 2>(half[0] | half[1]);
  }
}

/// Returns a number whose bit i says whether a comparison holds in lane i. For a whole register this takes one instruction; compilers
/// take ten without the special cases below.
template <int n>
INNER unsigned bits(const Comparison<n>& holds) {
#if defined(__clang__)
  if constexpr (n == 8) {
    typedef bool Bits __attribute__((ext_vector_type(n)));
    return __builtin_bit_cast(unsigned char, __builtin_convertvector(holds, Bits));
  }
#elif defined(__x86_64__)
  if constexpr (n == 8) {
    unsigned char found;
    __asm__("vptestmq %1, %1, %0" : "=k"(found) : "v"(holds));
    return found;
  }
  if constexpr (n == 4) {
    unsigned found;
    __asm__("vmovmskpd %1, %0" : "=r"(found) : "x"(holds));
    return found;
  }
#endif
  Comparison<n> bit{};
  for (int i = 0; i < n; ++i) bit[i] = 1 << i;
  return joined<n>(holds & bit);
}

/// Three coordinates of a vector in each lane.
template <int n>
struct Triple {
  Lanes<n> x{}, y{}, z{};
};

template <int n>
INNER Triple<n> load(const double* x, std::ptrdiff_t column) {
  return {load<n>(x), load<n>(x + column), load<n>(x + 2 * column)};
}

template <int n>
INNER void store(double* x, std::ptrdiff_t column, const Triple<n>& v) {
  store<n>(x, v.x), store<n>(x + column, v.y), store<n>(x + 2 * column, v.z);
}

}  // namespace softffd::kernels
