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

constexpr int count = 20000;
double of_exp(int n) { return 40.0 * n / count; }
double of_cos(int n) { return std::numbers::pi * n / count; }

/// In units of the last digit of a result.
double error(double found, long double exact) {
  const double size = std::abs(found);
  return double(std::abs(found - exact)) / (std::nextafter(size, std::numeric_limits<double>::infinity()) - size);
}

/// Half a unit, and what is left to a C library whose long double is a double.
constexpr double most = std::numeric_limits<long double>::digits > 60 ? 0.501 : 1.5;

std::uint64_t sum = 0;
void add(double value) { sum = std::rotl(sum, 7) ^ std::bit_cast<std::uint64_t>(value); }

}  // namespace

TEST(results_are_rounded_once) {
  double worst = 0;
  for (int n = 0; n <= count; ++n) {
    worst = std::max(worst, error(exp_minus(of_exp(n)), std::exp(-static_cast<long double>(of_exp(n)))));
    worst = std::max(worst, error(cos_to_pi(of_cos(n)), std::cos(static_cast<long double>(of_cos(n)))));
    const double a = std::exp(0.001 * n), b = std::exp(0.002 * n - 20);
    worst = std::max(worst, error(hypotenuse(a, -b), std::hypot(static_cast<long double>(a), static_cast<long double>(b))));
  }
  CHECK(worst <= most);
}

TEST(a_platform_gives_the_bits_of_the_others) {
  sum = 0;
  for (int n = 0; n <= count; ++n) {
    add(exp_minus(of_exp(n)));
    add(cos_to_pi(of_cos(n)));
    add(hypotenuse(1 + n, 0.37 * n));
  }
  CHECK(sum == 0x27548bfcf2307f22);
}

TEST(a_hypotenuse_neither_overflows_nor_vanishes) {
  const double infinite = std::numeric_limits<double>::infinity();
  CHECK(hypotenuse(3e300, 4e300) == 5e300 && hypotenuse(3e-310, -4e-310) > 4.99e-310);
  CHECK(hypotenuse(0, -3) == 3 && hypotenuse(0, 0) == 0 && hypotenuse(-infinite, 1) == infinite);
  CHECK(std::isnan(hypotenuse(std::nan(""), 1)));
}
