/// exp, cos and hypot with the same bits on every platform; those of C libraries differ in the last bit.
///
/// They use only operations that IEEE 754 fixes. Numbers are sums high + low of two doubles; the error lies 20 digits and more behind the
/// first, so that nearly every result is the double nearest to the exact one. For damped kicks and energy accounts, which need few.
#pragma once

namespace softffd {

/// Returns e^-z; z: 0 to 40 [1].
double exp_minus(double z);
/// Returns the cosine of an angle of 0 to pi [rad].
double cos_to_pi(double angle);
/// Returns sqrt(a^2 + b^2), without overflow.
double hypotenuse(double a, double b);

}  // namespace softffd
