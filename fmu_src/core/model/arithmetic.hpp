/// Arithmetic that, unlike the C library's, gives the same bits on every processor, and whole numbers of steps.
#pragma once
#include <cmath>
#include <cstring>
#include <limits>

#include "model/types.hpp"

namespace softffd {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Returns the larger of two errors; NaN counts as larger than any number.
inline double worse(double a, double b) { return std::isnan(a) || a > b ? a : b; }
/// Returns the smaller of two limits; NaN counts as smaller than any number.
inline double tighter(double a, double b) { return std::isnan(a) || a < b ? a : b; }
/// Returns base^exponent by multiplication.
double power(double base, int exponent);
/// Returns the root x of x^exponent = value in [low, high] by bisection: the C library's power differs in the last bit between processors.
double root(double value, int exponent, double low, double high);
/// True if all values have the same bits.
template <class Values>
bool all_alike(const Values& values) {
  return values.size() < 2 || std::memcmp(values.data(), values.data() + 1, (values.size() - 1) * sizeof(double)) == 0;
}
/// Returns the smallest number of equal parts of a length that are not longer than the limit.
Count divisions(double length, double limit);

}  // namespace softffd
