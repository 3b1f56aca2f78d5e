/// A few numbers side by side, in the compiler's own vector type: as many as a register holds. No operation mixes lanes, so the bits are
/// the same for any number. Included by the files of vectorised loops alone.
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

/// What a comparison gives: -1 or 0 in each lane.
template <int n>
using Comparison = decltype(Lanes<n>{} < Lanes<n>{});

/// All bits of the lanes.
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

/// One bit in each lane, from this one on.
template <int n>
INNER Comparison<n> each_bit(int from = 0) {
  Comparison<n> bit{};
  for (int i = 0; i < n; ++i) bit[i] = 1 << (from + i);
  return bit;
}

/// Bit i: whether a comparison holds in lane i.
template <int n>
INNER unsigned bits(const Comparison<n>& holds) {
  return joined<n>(holds & each_bit<n>());
}

/// Three coordinates side by side.
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
