#include "body/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softffd {

namespace {

/// Squared frequencies below this are those of a point without springs [1/s2].
constexpr double no_frequency = 1e-300;
/// Of the largest frequency by the bound above to the geometric mean of the uniform lattice's lowest and highest; the time scale of points
/// that hardly anything holds [s].
constexpr double bound_to_mean = 4.3, longest = 100;

/// k (1 + sqrt(m_here / m_there)); a pinned end is infinitely heavy.
double weight(const Body& body, double k, int here, int there) {
  if (body.pinned[here]) return 0;
  return body.pinned[there] ? k : k * (1 + std::sqrt(body.mass[here] / body.mass[there]));
}

}  // namespace

void Stability::prepare(const Body& body) {
  const auto& rows = body.springs.rows();
  first_.resize(rows.size());
  second_.resize(rows.size());
  Scalars &plain = mean_, &weighted = spread_;
  plain.setZero();
  weighted.setZero();
  for (std::size_t d = 0; d < rows.size(); ++d) {
    const auto& row = rows[d];
    first_[d].resize(row.lanes());
    second_[d].resize(row.lanes());
    for (int lane = 0; lane < row.lanes(); ++lane) {
      const int p = row.begin + lane, q = p + row.offset;
      const double k = row.stiffness[lane];
      first_[d][lane] = weight(body, k, p, q);
      second_[d][lane] = weight(body, k, q, p);
      weighted[p] += first_[d][lane];
      weighted[q] += second_[d][lane];
      plain[p] += body.pinned[p] ? 0 : 2 * k;
      plain[q] += body.pinned[q] ? 0 : 2 * k;
    }
  }
  any_squared_ = weighted / body.mass;
  any_frequency_ = std::sqrt(std::min((weighted / body.mass).maxCoeff(), (plain / body.mass).maxCoeff()));
  elastic_ = any_frequency_ > 0 || body.volume;
}

void Stability::time_scales(const Body& body, Scalars& scales) const {
  const int n = body.points();
  for (int i = 0; i < 3 * n; ++i) scales[i] = std::min(bound_to_mean / std::sqrt(std::max(any_squared_[i % n], no_frequency)), longest);
}

double Stability::frequency(const Body& body, const Points& x) const {
  const int n = body.points();
  sums_.setZero();
  const auto& rows = body.springs.rows();
  for (std::size_t d = 0; d < rows.size(); ++d)
    kernels::add_stiffness_bounds(rows[d].view(), n, x.data(), first_[d].data(), second_[d].data(), sums_.data(), body.springs.scratch());
  const bool crushed = body.volume && body.volume->add_bounds(x, body.mass, body.pinned, sums_);
  const auto part = [&](int c) { return sums_.segment(c * n, n); };
  // lambda_max <= mean + 2 sqrt(|S - mean I|^2 / 6), with equality where the two smaller eigenvalues agree
  mean_ = (part(0) + part(1) + part(2)) / 3;
  spread_ = (part(0) - mean_).square() + (part(1) - mean_).square() + (part(2) - mean_).square() +
            2 * (part(3).square() + part(4).square() + part(5).square());
  const double squared = ((mean_ + 2 * (spread_ / 6).sqrt()) / body.mass).maxCoeff();
  return crushed ? std::sqrt(squared) : std::min(std::sqrt(squared), any_frequency_);
}

double Stability::stable_step(const Body& body, const Points& x) const {
  if (!elastic_) return std::numeric_limits<double>::max();
  const double step = 2 / frequency(body, x);
  return step > 0 ? std::min(step, std::numeric_limits<double>::max()) : 0;
}

}  // namespace softffd
