#include "body/damped_kick.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "machine/elementary.hpp"

namespace softffd {

namespace {

/// Largest number of products. With more, rounding would show; kicks that need more are for implicit methods.
constexpr int most_products = 1000;

double psi(double z) {
  if (z > 0.5) return ((z < 40 ? exp_minus(z) : 0) - 1 + z) / (z * z);
  double term = 0.5, sum = term;
  for (int k = 3; k < 16; ++k) sum += term *= -z / k;
  return sum;
}

/// Sets `coefficients` to the coefficients of the polynomial of this degree that equals psi at Chebyshev's points of [0, reach], both ends
/// included.
void interpolate(int degree, double reach, std::vector<double>& coefficients) {
  coefficients.assign(degree + 1, degree == 0 ? psi(0) : 0.0);
  if (degree == 0) return;
  for (int k = 0; k <= degree; ++k) {
    const double x = cos_to_pi(std::numbers::pi * k / degree);
    const double value = psi(0.5 * reach * (1 - x)) * (k == 0 || k == degree ? 1.0 : 2.0) / degree;
    double before = x, now = 1;  // T_-1, T_0
    for (int j = 0; j <= degree; ++j) {
      coefficients[j] += value * now;
      before = std::exchange(now, 2 * x * now - before);
    }
  }
  coefficients[0] *= 0.5;
  coefficients[degree] *= 0.5;
}

}  // namespace

DampedKick::DampedKick(int points) {
  for (Points* each : {&acceleration_, &now_, &before_, &product_, &sum_}) each->setZero(points, 3);
  pinned_.reserve(points);
  coefficients_.reserve(most_products);
}

/// The number is so large that at most 1 / z of a motion is left. The formula is fitted to a search over all z for 2 to 200 products.
int DampedKick::products(double reach) {
  if (reach <= 1.3) return 2;
  const double digits = std::log(reach), wanted = 0.5 + std::sqrt(reach * digits * (1.25 + 0.055 * digits));
  return int(std::ceil(std::clamp(wanted, 3.0, double(most_products))));
}

void DampedKick::prepare(const Body& body, double t, double rate) {
  if (t == t_ && rate == rate_ && body.version == version_) return;
  rate_ = rate;
  t_ = t;
  version_ = body.version;
  pinned_.clear();
  for (int p = 0; p < body.points(); ++p)
    if (body.pinned[p]) pinned_.push_back(p);
  scale_ = -t / body.mass;
  opposed_ = -body.damping;
  reach_ = t * rate_;
  interpolate(products(reach_) - 2, reach_, coefficients_);
}

void DampedKick::hold_pins(const Points& v0, Points& v) const {
  for (const int p : pinned_) set_row(v, p, row(v0, p));
}

void DampedKick::multiply(const Body& body, const Points& x, Points& v, Points& out) const {
  for (const int p : pinned_) set_row(v, p, Vec3::Zero());
  kernels::scale(body.points(), opposed_.data(), v.data(), out.data());
  body.add_dashpot_force(x, v, out);
  kernels::scale(body.points(), scale_.data(), out.data(), out.data());
}

void DampedKick::apply(const Body& body, const Points& x, const Points& inner, const Points& outside, const Points& v0, Points& v) {
  kernels::begin_kick(body.points(), body.mass.data(), body.damping.data(), inner.data(), outside.data(), v0.data(), coefficients_[0],
                      acceleration_.data(), sum_.data());
  if (coefficients_.size() > 1) now_ = acceleration_;
  for (std::size_t j = 1; j < coefficients_.size(); ++j) {
    multiply(body, x, now_, product_);
    if (j == 1) {
      before_ = now_ - (2 / reach_) * product_;
    } else {
      before_ = 2 * now_ - before_ - (4 / reach_) * product_;
    }
    now_.swap(before_);
    sum_ += coefficients_[j] * now_;
  }
  multiply(body, x, sum_, product_);
  kernels::end_kick(v.size(), t_, v0.data(), acceleration_.data(), product_.data(), v.data());
}

double DampedKick::loss(const Body& body, const Points& spring, const Points& outside, const Points& v0, const Points& v, bool drifted) {
  Points &mean = now_, &way = before_;
  mean = 0.5 * (v0 + v);
  if (drifted)
    way = v - t_ * sum_;
  else
    way = v0 + t_ * sum_;
  for (Points* each : {&mean, &way}) hold_pins(v0, *each);
  double energy = 0;
  for (int axis = 0; axis < 3; ++axis)
    energy +=
        (t_ * way.col(axis) * (spring.col(axis) + outside.col(axis)) - mean.col(axis) * body.mass * (v.col(axis) - v0.col(axis))).sum();
  return energy;
}

}  // namespace softffd
