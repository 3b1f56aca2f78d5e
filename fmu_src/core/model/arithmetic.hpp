/// Arithmetic that the C library does not give in the same bits on every processor, and whole numbers of steps.
#pragma once
#include <cmath>
#include <cstring>
#include <limits>

#include "model/types.hpp"

namespace softffd {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// The larger of two errors; what is not a number is larger than any.
inline double worse(double a, double b) { return std::isnan(a) || a > b ? a : b; }
/// The smaller of two limits; what is not a number is smaller than any.
inline double tighter(double a, double b) { return std::isnan(a) || a < b ? a : b; }
/// base^exponent by multiplication.
double power(double base, int exponent);
/// The root x of x^exponent = value, between low and high. Bisection: the C library's power differs in the last bit between processors.
double root(double value, int exponent, double low, double high);
/// Whether all of them have the same bits.
template <class Values>
bool all_alike(const Values& values) {
  return values.size() < 2 || std::memcmp(values.data(), values.data() + 1, (values.size() - 1) * sizeof(double)) == 0;
}
/// Equal parts of a length that are not longer than the limit.
Count divisions(double length, double limit);

}  // namespace softffd
