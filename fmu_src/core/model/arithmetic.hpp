/// Arithmetic that the C library does not give in the same bits on every processor, and whole numbers of steps.
#pragma once
#include "model/types.hpp"

namespace softffd {

/// base^exponent by multiplication.
double power(double base, int exponent);
/// The root x of x^exponent = value, between low and high. Bisection: the C library's power differs in the last bit between processors.
double root(double value, int exponent, double low, double high);
/// Equal parts of a length that are not longer than the limit.
Count divisions(double length, double limit);

}  // namespace softffd
