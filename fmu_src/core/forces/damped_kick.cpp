#include "forces/damped_kick.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

namespace {

/// Of the stability polynomials: what keeps them below 1 between their ends.
constexpr double shrinking = 2.0 / 13;
/// Stages beyond which rounding would show; kicks that need more are for implicit methods.
constexpr int most_stages = 1000;

/// Chebyshev's polynomial of degree n with its first two derivatives.
struct Chebyshev {
  double value, slope, bend;
};

/// Degrees 0 to n at w.
std::vector<Chebyshev> chebyshev(int n, double w) {
  std::vector<Chebyshev> all{{1, 0, 0}, {w, 1, 0}};
  for (int j = 2; j <= n; ++j) {
    const Chebyshev &a = all[j - 1], &b = all[j - 2];
    all.push_back({2 * w * a.value - b.value, 2 * a.value + 2 * w * a.slope - b.slope, 4 * a.slope + 2 * w * a.bend - b.bend});
  }
  return all;
}

double point_for(int stages) { return 1 + shrinking / (double(stages) * stages); }

/// Up to which time times rate a number of stages is stable.
double stable_for(int stages) {
  const double w = point_for(stages);
  const Chebyshev last = chebyshev(stages, w).back();
  return (w + 1) * last.bend / last.slope;
}

}  // namespace

DampedKick::DampedKick(int points) {
  for (Points* each : {&moving_, &start_slope_, &slope_, &before_, &stage_}) each->setZero(points, 3);
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
  const std::vector<Chebyshev> T = chebyshev(stages, w0);
  const double w1 = T[stages].slope / T[stages].bend;
  const auto b = [&](int j) { return T[std::max(j, 2)].bend / (T[std::max(j, 2)].slope * T[std::max(j, 2)].slope); };
  first_ = b(1) * w1;
  rows_.clear();
  for (int j = 2; j <= stages; ++j) {
    const double step = 2 * b(j) * w1 / b(j - 1);
    rows_.push_back({2 * b(j) * w0 / b(j - 1), -b(j) / b(j - 2), step, -(1 - b(j - 1) * T[j - 1].value) * step});
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
  double power = dashpot_power(body.springs, x, moving_, slope_);
  for (int axis = 0; axis < 3; ++axis) power += (body.damping * moving_.col(axis).square()).sum();
  return t_ * power;
}

}  // namespace softffd
