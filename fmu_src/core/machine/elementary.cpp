#include "machine/elementary.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

namespace {

/// The number high + low, where low is the rounding error of high. T. J. Dekker, "A floating-point technique for extending the available
/// precision", 1971.
struct Twofold {
  double high, low = 0;
};

/// Returns a + b with its rounding error. Requires |a| >= |b|, or a = 0.
Twofold sum(double a, double b) {
  const double high = a + b;
  return {high, b - (high - a)};
}

Twofold times(const Twofold& a, const Twofold& b) {
  const double high = a.high * b.high;
  return sum(high, std::fma(a.high, b.high, -high) + (a.high * b.low + a.low * b.high));
}

/// Returns 1 + x t / n. With this step a series is summed from its last term to its first.
Twofold step(const Twofold& x, const Twofold& t, double n) {
  const Twofold product = times(x, t);
  const double ratio = product.high / n, left = (std::fma(-ratio, n, product.high) + product.low) / n;
  const Twofold all = sum(1, ratio);
  return sum(all.high, all.low + left);
}

constexpr Twofold half_pi{1.5707963267948966, 6.123233995736766e-17};
constexpr double half_pi_rest = -1.4973849048591833e-33;

/// Returns cos d (odd = 0) or sin d / d (odd = 1), |d| <= pi / 4.
Twofold even_series(const Twofold& d, int odd) {
  const Twofold square = times(d, d);
  Twofold t{1};
  for (int n = 24; n > 0; n -= 2) t = step({-square.high, -square.low}, t, (n - 1 + odd) * (n + odd));
  return t;
}

}  // namespace

double exp_minus(double z) {
  Twofold t{1};
  for (int n = 18; n > 0; --n) t = step({-z / 128}, t, n);
  for (int doubling = 0; doubling < 7; ++doubling) t = times(t, t);
  return t.high;
}

double cos_to_pi(double angle) {
  Twofold beside = sum(half_pi.high - angle, half_pi.low);  // the difference is exact
  beside.low += half_pi_rest;
  if (angle < 0.5 * half_pi.high) return even_series({angle}, 0).high;
  if (angle > 1.5 * half_pi.high) return -even_series(sum(2 * half_pi.high - angle, 2 * half_pi.low), 0).high;
  return times(beside, even_series(beside, 1)).high;
}

double hypotenuse(double a, double b) {
  if (a == 0 || b == 0 || !std::isfinite(a) || !std::isfinite(b)) return std::hypot(a, b);  // one of them is 0 or not finite
  const double large = std::max(std::abs(a), std::abs(b)), small = std::min(std::abs(a), std::abs(b));
  const int exponent = std::ilogb(large);
  const Twofold x{std::scalbn(large, -exponent)}, y{std::scalbn(small, -exponent)}, xx = times(x, x), yy = times(y, y);
  const Twofold squares = sum(xx.high, yy.high);
  const double root = std::sqrt(squares.high), more = squares.low + (xx.low + yy.low) - std::fma(root, root, -squares.high);
  return std::scalbn(root + more / (2 * root), exponent);
}

}  // namespace softffd
