/// exp, cos and hypot with the same bits on every platform; those of C libraries differ in the last one.
///
/// Only operations that IEEE 754 fixes: numbers are sums high + low of two doubles, and what is left out lies 20 digits and more behind the
/// first. So nearly every result is the double nearest to the exact one; for damped kicks and books, which need few of them.
#pragma once

namespace softffd {

/// e^-z; z: 0 to 40. [1]
double exp_minus(double z);
/// angle: 0 to pi [rad].
double cos_to_pi(double angle);
/// sqrt(a^2 + b^2), without overflow.
double hypotenuse(double a, double b);

}  // namespace softffd
