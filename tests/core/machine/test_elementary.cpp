#include "machine/elementary.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "check.hpp"

using namespace softffd;

namespace {

constexpr int arguments = 20000;
double exp_argument(int n) { return 40.0 * n / arguments; }
double cos_argument(int n) { return std::numbers::pi * n / arguments; }

/// By how many units of its last digit a result is off.
double units_off(double found, long double exact) {
  const double size = std::abs(found);
  return double(std::abs(found - exact)) / (std::nextafter(size, std::numeric_limits<double>::infinity()) - size);
}

/// Half a unit; more where the C library's long double is a double.
constexpr double most_units_off = std::numeric_limits<long double>::digits > 60 ? 0.501 : 1.5;

}  // namespace

TEST(results_are_rounded_once) {
  double worst = 0;
  for (int n = 0; n <= arguments; ++n) {
    worst = std::max(worst, units_off(exp_minus(exp_argument(n)), std::exp(-static_cast<long double>(exp_argument(n)))));
    worst = std::max(worst, units_off(cos_to_pi(cos_argument(n)), std::cos(static_cast<long double>(cos_argument(n)))));
    const double a = std::exp(0.001 * n), b = std::exp(0.002 * n - 20);
    worst = std::max(worst, units_off(hypotenuse(a, -b), std::hypot(static_cast<long double>(a), static_cast<long double>(b))));
  }
  CHECK(worst <= most_units_off);
}

TEST(a_platform_gives_the_bits_of_the_others) {
  std::uint64_t bits = 0;
  for (int n = 0; n <= arguments; ++n)
    for (const double result : {exp_minus(exp_argument(n)), cos_to_pi(cos_argument(n)), hypotenuse(1 + n, 0.37 * n)})
      bits = std::rotl(bits, 7) ^ std::bit_cast<std::uint64_t>(result);
  CHECK(bits == 0x27548bfcf2307f22);
}

TEST(a_hypotenuse_neither_overflows_nor_vanishes) {
  const double infinite = std::numeric_limits<double>::infinity();
  CHECK(hypotenuse(3e300, 4e300) == 5e300 && hypotenuse(3e-310, -4e-310) > 4.99e-310);
  CHECK(hypotenuse(0, -3) == 3 && hypotenuse(0, 0) == 0 && hypotenuse(-infinite, 1) == infinite);
  CHECK(std::isnan(hypotenuse(std::nan(""), 1)) && std::isnan(hypotenuse(1, std::nan(""))));
}
