#include "forces/damped_kick.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

namespace {

/// Of the stability polynomials: what keeps them below 1 between their ends.
constexpr double shrinking = 2.0 / 13;
/// Stages beyond which rounding would show; kicks that need more are for implicit methods.
constexpr int most_stages = 1000;

/// Chebyshev's polynomials at w, one after the other from degree 1 on, with their first two derivatives.
class Chebyshev {
 public:
  explicit Chebyshev(double w) : w_(w), value(w) {}
  void next() {
    const double v = 2 * w_ * value - value_before_, s = 2 * value + 2 * w_ * slope - slope_before_;
    const double b = 4 * slope + 2 * w_ * bend - bend_before_;
    value_before_ = value, slope_before_ = slope, bend_before_ = bend;
    value = v, slope = s, bend = b;
  }

 private:
  double w_, value_before_ = 1, slope_before_ = 0, bend_before_ = 0;

 public:
  double value, slope = 1, bend = 0;
};

Chebyshev chebyshev(int degree, double w) {
  Chebyshev polynomial(w);
  for (int j = 1; j < degree; ++j) polynomial.next();
  return polynomial;
}

double point_for(int stages) { return 1 + shrinking / (double(stages) * stages); }

/// Up to which time times rate a number of stages is stable.
double stable_for(int stages) {
  const double w = point_for(stages);
  const Chebyshev last = chebyshev(stages, w);
  return (w + 1) * last.bend / last.slope;
}

}  // namespace

DampedKick::DampedKick(int points) {
  for (Points* each : {&moving_, &start_slope_, &slope_, &before_, &stage_}) each->setZero(points, 3);
  pinned_.reserve(points);
  rows_.reserve(most_stages);
}

int DampedKick::stages(const Body& body, double t) {
  const double reach = t * body.fastest_damping;
  int stages = std::clamp(int(std::min(std::sqrt(1.5 * reach), double(most_stages))), 2, most_stages);
  while (stages < most_stages && stable_for(stages) < reach) ++stages;
  return stages;
}

void DampedKick::prepare(const Body& body, double t) {
  t_ = t;
  pinned_.clear();
  for (int p = 0; p < body.points(); ++p)
    if (body.pinned[p]) pinned_.push_back(p);
  const int stages = DampedKick::stages(body, t);
  const double w0 = point_for(stages);
  const Chebyshev last = chebyshev(stages, w0), second = chebyshev(2, w0);
  const double w1 = last.slope / last.bend;
  const auto share = [](const Chebyshev& T) { return T.bend / (T.slope * T.slope); };
  double b2 = share(second), b1 = b2, below = 1 - b1 * w0;  // b of degree j - 2 and j - 1, 1 - b T of degree j - 1
  first_ = b1 * w1;
  rows_.clear();
  for (Chebyshev T(w0); int(rows_.size()) < stages - 1;) {
    T.next();
    const double b = share(T), step = 2 * b * w1 / b1;
    rows_.push_back({2 * b * w0 / b1, -b / b2, step, -below * step});
    below = 1 - b * T.value;
    b2 = b1, b1 = b;
  }
}

void DampedKick::hold_pins(const Points& v0, Points& v) const {
  for (const int p : pinned_) set_row(v, p, row(v0, p));
}

void DampedKick::finish(const Body& body, const Points& v, Points& slope) {
  for (int axis = 0; axis < 3; ++axis) slope.col(axis) = (slope.col(axis) - body.damping * v.col(axis)) / body.mass;
}

void DampedKick::apply(const Body& body, const Points& x, const Points& spring, const Points& inner, const Points& outside,
                       const Points& v0, Points& v) {
  start_slope_ = inner + outside;
  finish(body, v0, start_slope_);
  before_ = v0;
  v = v0 + (first_ * t_) * start_slope_;
  for (const Row& row : rows_) {
    moving_ = v;
    hold_pins(v0, moving_);
    slope_ = spring + outside;
    body.springs.add_dashpot_force(x, moving_, slope_);
    finish(body, moving_, slope_);
    stage_ = (1 - row.mu - row.nu) * v0 + row.mu * v + row.nu * before_ + (row.step * t_) * slope_ + (row.first * t_) * start_slope_;
    before_.swap(v);
    v.swap(stage_);
  }
}

double DampedKick::loss(const Body& body, const Points& x, const Points& v0, const Points& v) {
  moving_ = 0.5 * (v0 + v);
  hold_pins(v0, moving_);
  double power = dashpot_power(body.springs, x, moving_);
  for (int axis = 0; axis < 3; ++axis) power += (body.damping * moving_.col(axis).square()).sum();
  return t_ * power;
}

}  // namespace softffd
