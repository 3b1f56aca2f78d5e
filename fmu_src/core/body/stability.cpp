#include "body/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softffd {

namespace {

/// Squared frequencies below this value belong to points without springs [1/s2].
constexpr double no_frequency = 1e-300;
/// Ratio of the upper bound of the largest frequency to the geometric mean of the uniform lattice's lowest and highest frequency [1].
constexpr double bound_to_mean = 4.3;
/// Largest time scale: of bodies that nothing holds [s], and of points that hardly anything holds, relative to the body's smallest [1].
constexpr double longest = 100, longest_ratio = 1e7;

}  // namespace

void Stability::prepare(const Body& body) {
  for (Scalars* bounds : {&any_.weighted, &any_.plain}) bounds->setZero(body.points());
  any_.exist = true;
  for (const auto& each : body.energies) each->add_any_bounds(body.mass, body.prescribed(), any_);
  any_frequency_ = std::sqrt(std::min((any_.weighted / body.mass).maxCoeff(), (any_.plain / body.mass).maxCoeff()));
  elastic_ = any_frequency_ > 0 || !any_.exist;
}

void Stability::time_scales(const Body& body, Scalars& scales) const {
  const int n = body.points();
  const auto scale = [](double squared) { return bound_to_mean / std::sqrt(squared); };
  const double largest = (any_.weighted / body.mass).maxCoeff(), most = largest > no_frequency ? longest_ratio * scale(largest) : longest;
  for (int i = 0; i < 3 * n; ++i) {
    const double squared = any_.weighted[i % n] / body.mass[i % n];
    scales[i] = std::min(scale(std::max(squared, no_frequency)), most);
  }
}

double Stability::frequency(const Body& body, const Points& x) const {
  const int n = body.points();
  sums_.setZero();
  bool beyond = false;
  for (const auto& each : body.energies) beyond = each->add_bounds(x, body.mass, body.prescribed(), sums_) || beyond;
  const auto part = [&](int c) { return sums_.segment(c * n, n); };
  // lambda_max <= mean + 2 sqrt(|S - mean I|^2 / 6), with equality where the two smaller eigenvalues agree
  mean_ = (part(0) + part(1) + part(2)) / 3;
  spread_ = (part(0) - mean_).square() + (part(1) - mean_).square() + (part(2) - mean_).square() +
            2 * (part(3).square() + part(4).square() + part(5).square());
  const double squared = ((mean_ + 2 * (spread_ / 6).sqrt()) / body.mass).maxCoeff();
  return beyond ? std::sqrt(squared) : std::min(std::sqrt(squared), any_frequency_);
}

double Stability::stable_step(const Body& body, const Points& x) const {
  if (!elastic_) return std::numeric_limits<double>::max();
  const double step = 2 / frequency(body, x);
  return step > 0 ? std::min(step, std::numeric_limits<double>::max()) : 0;
}

}  // namespace softffd
