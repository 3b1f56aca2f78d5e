#include "contact/surface/sample_search.hpp"

#include <algorithm>
#include <limits>

#include "contact/surface/surface_loops.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// The reserve of a search lasts for steps_ahead steps, or steps_of_long_list if the list is long already. Its limits are fractions of
/// the box: rounding at rest causes no search, and lists stay short.
constexpr double steps_ahead = 16, steps_of_long_list = 4, least_reserve = 1e-4, most_reserve = 2e-2;
constexpr std::size_t long_list = 64;

}  // namespace

SampleSearch::SampleSearch(const Samples& samples, int planes, double length) : samples_(samples), length_(length), planes_(planes) {
  Points room;
  rest_ = samples.hull(rest_positions(samples.lattice()), room);
  for (int a = 0; a < 3; ++a) {
    middle_[a] = rest_.col(a).mean();
    squares_[a] = (rest_.col(a) - middle_[a]).square().sum();
  }
}

bool SampleSearch::covers(int q, const Scalars& of_points) {
  const Scalars& gaps = samples_.hull(of_points, room_);
  Known& known = planes_[q];
  const double touch = touching * length_;
  if (known.gaps.size() == 0) known.gaps = gaps;
  const kernels::Descent way = kernels::descent(gaps.size(), known.gaps.data(), gaps.data());
  known.away = way.least > touch;
  return known.away || (known.reserve > 0 && way.most < known.reserve - 2 * touch);
}

bool SampleSearch::is_long(int q) const { return near(q).size() > long_list; }

bool SampleSearch::in_front(int q, const Scalars& of_points, double slack) {
  return planes_[q].away || (samples_.hull(of_points, room_) + planes_[q].idle).minCoeff() >= -slack;
}

void SampleSearch::look(int q, const Scalars& of_points, double way) {
  const Scalars& gaps = samples_.hull(of_points, room_);
  Known& known = planes_[q];
  ++searches_;
  const double steps = known.near.size() > long_list ? steps_of_long_list : steps_ahead;
  known.reserve = std::clamp(steps * way, least_reserve * length_, most_reserve * length_);
  known.gaps = gaps;
  Vec3 slope;  // axes of a lattice are independent of each other
  for (int a = 0; a < 3; ++a) slope[a] = ((rest_.col(a) - middle_[a]) * gaps).sum() / squares_[a];
  const double base = gaps.mean() - slope.dot(middle_);
  left_ = gaps - base - slope[0] * rest_.col(0) - slope[1] * rest_.col(1) - slope[2] * rest_.col(2);
  const double bound = known.reserve * (1 + 1e-9) - left_.minCoeff() - base;
  known.near.clear();
  for (int s = 0; s < samples_.count(); ++s)
    if (slope.dot(samples_.place(s)) < bound && samples_.at(s, of_points.data()) < known.reserve) known.near.push_back(s);
  known.idle = Scalars::Constant(gaps.size(), std::numeric_limits<double>::infinity());
  for (const int s : known.near) samples_.mark(s, 0.0, known.idle.data());
}

}  // namespace softffd
