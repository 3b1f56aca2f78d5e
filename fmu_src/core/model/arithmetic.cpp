#include "model/arithmetic.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

double power(double base, int exponent) {
  double product = 1;
  for (int i = 0; i < exponent; ++i) product *= base;
  return product;
}

double root(double value, int exponent, double low, double high) {
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (power(middle, exponent) < value ? low : high) = middle;
  }
  return low;
}

Count divisions(double length, double limit) {
  constexpr double most = 0x1p53;
  return std::max(Count{1}, Count(std::min(most, std::ceil(length / limit * (1 - 1e-12)))));
}

}  // namespace softffd
