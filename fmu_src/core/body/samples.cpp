#include "body/samples.hpp"

#include <algorithm>

#include "machine/lanes.hpp"
#include "model/lobatto.hpp"

namespace softffd {

namespace kernels {
namespace {

/// Computes the sums of x_i y_j z_k values(i, j, k) for four control points per axis, the usual case, of each of the columns of values.
/// line, layer, column: distance in memory from one to the next.
template <int columns>
INNER void weigh_columns(In factors, const double* values, int line, int layer, std::ptrdiff_t column, double* sums) {
  const double *x = factors, *y = factors + 4, *z = factors + 8;
  Lanes<4> sum[columns]{};
  for (int j = 0; j < 4; ++j) {
    Lanes<4> along[columns];
    for (int k = 0; k < 4; ++k)
      for (int c = 0; c < columns; ++c) {
        const Lanes<4> each = z[k] * load<4>(values + j * line + k * layer + c * column);
        along[c] = k == 0 ? each : along[c] + each;
      }
    for (int c = 0; c < columns; ++c) sum[c] += y[j] * along[c];
  }
  for (int c = 0; c < columns; ++c) {
    sum[c] *= load<4>(x);
    sums[c] = (sum[c][0] + sum[c][1]) + (sum[c][2] + sum[c][3]);
  }
}

/// values(i, j, k) += factor more, for four values per line, in each column with its own factor.
INNER void add_lines(In factor, In more, double* values, int lines, int line, int layers, int layer, int columns, std::ptrdiff_t column) {
  const double* from = more;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < lines; ++j, from += 4) {
      double* at = values + j * line + k * layer;
      const Lanes<4> weights = load<4>(from);
      for (int c = 0; c < columns; ++c, at += column) store<4>(at, load<4>(at) + factor[c] * weights);
    }
}

const auto weigh_one = chosen<weigh_columns<1>>();
const auto weigh_three = chosen<weigh_columns<3>>();
const auto add_lines_here = chosen<add_lines>();

}  // namespace
}  // namespace kernels

namespace {

double weighted_sum(const double* x, const double* y, const double* z, const std::array<int, 3>& n, const double* values, int line,
                    int layer) {
  double sum = 0;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      double along = 0;
      for (int i = 0; i < n[0]; ++i) along += x[i] * values[i + j * line + k * layer];
      sum += z[k] * y[j] * along;
    }
  return sum;
}

}  // namespace

Samples::Samples(Basis basis, const Lattice& lattice, const std::vector<Vec3>& places)
    : lattice_(lattice), counts_(lattice.counts), places_(places) {
  for (int a = 0; a < 3; ++a) width_[a] = basis == Basis::bezier ? counts_[a] : std::min(counts_[a], 4);
  fours_ = width_ == std::array{4, 4, 4};
  for (const Vec3& place : places_) {
    std::array<int, 3> first;
    for (int a = 0; a < 3; ++a) {
      const double fraction = std::clamp((place[a] - lattice.origin[a]) / lattice.size[a], 0.0, 1.0);  // outside, weights would be negative
      const Scalars all = softffd::weights(basis, fraction, counts_[a]);
      first[a] = 0;
      if (of_nodes()) first[a] = 3 * std::min(int(fraction * lobatto::patches(counts_[a])), lobatto::patches(counts_[a]) - 1);
      while (!of_nodes() && all[first[a]] == 0 && first[a] + width_[a] < counts_[a]) ++first[a];
      factors_.insert(factors_.end(), all.begin() + first[a], all.begin() + first[a] + width_[a]);
    }
    first_.push_back(first);
  }
}

Samples::Samples(const Lattice& lattice) : lattice_(lattice), counts_(lattice.counts), width_{1, 1, 1}, fours_(false) {
  const Points rest = rest_positions(lattice);
  for (int p = 0; p < lattice.points(); ++p) {
    places_.push_back(row(rest, p));
    first_.push_back({p % counts_[0], p / counts_[0] % counts_[1], p / (counts_[0] * counts_[1])});
  }
  factors_.assign(3 * places_.size(), 1.0);
}

void Samples::add_idle(int number) {
  first_.resize(first_.size() + number, {0, 0, 0});
  factors_.resize(factors_.size() + std::size_t(number) * (width_[0] + width_[1] + width_[2]), 0.0);
}

const Scalars& Samples::hull(const Scalars& values, Scalars& room) const {
  if (!of_nodes()) return values;
  room = values;
  lobatto::to_control_points(lattice_, room.data());
  return room;
}

const Points& Samples::hull(const Points& values, Points& room) const {
  if (!of_nodes()) return values;
  lobatto::to_control_points(lattice_, values, room);
  return room;
}

double Samples::at(int s, const double* values) const {
  double sum;
  at<1>(s, values, 0, &sum);
  return sum;
}

Vec3 Samples::at(int s, const Points& x) const {
  Vec3 place;
  at<3>(s, x.data(), x.rows(), place.data());
  return place;
}

template <int columns>
void Samples::at(int s, const double* values, std::ptrdiff_t column, double* sums) const {
  const int line = counts_[0], layer = counts_[0] * counts_[1];
  values += begin(s);
  if (fours_) return (columns == 1 ? kernels::weigh_one : kernels::weigh_three)(factors(s), values, line, layer, column, sums);
  const double *x = factors(s), *y = x + width_[0], *z = y + width_[1];
  for (int c = 0; c < columns; ++c) sums[c] = weighted_sum(x, y, z, width_, values + c * column, line, layer);
}

void Samples::weights(int s, const Scalars& scale, double* out) const {
  const double *x = factors(s), *y = x + width_[0], *z = y + width_[1];
  for (int k = 0; k < width_[2]; ++k)
    for (int j = 0; j < width_[1]; ++j) {
      const double factor = z[k] * y[j], *here = scale.data() + begin(s) + counts_[0] * (j + counts_[1] * k);
      for (int i = 0; i < width_[0]; ++i) *out++ = factor * x[i] * here[i];
    }
}

PointRange Samples::range(const double* weights, int samples, int points) {
  PointRange range{points, 0};
  for (int s = 0; s < samples; ++s, weights += points)
    for (int p = 0; p < points; ++p)
      if (weights[p] != 0) range = {std::min(range.begin, p / 8 * 8), std::max(range.end, std::min(points, p / 8 * 8 + 8))};
  return range;
}

double Samples::product(int t, int s, const double* of_s) const {
  if (fours_ && first_[t] == first_[s]) {
    double sum;
    kernels::weigh_one(factors(t), of_s, 4, 16, 0, &sum);
    return sum;
  }
  std::array<const double*, 3> factor{factors(t), factors(t) + width_[0], factors(t) + width_[0] + width_[1]};
  std::array<int, 3> begin, common;
  for (int a = 0; a < 3; ++a) {
    const int first = std::max(first_[t][a], first_[s][a]);
    common[a] = std::min(first_[t][a], first_[s][a]) + width_[a] - first;
    if (common[a] <= 0) return 0;
    factor[a] += first - first_[t][a];
    begin[a] = first - first_[s][a];
  }
  return weighted_sum(factor[0], factor[1], factor[2], common, of_s + begin[0] + width_[0] * (begin[1] + width_[1] * begin[2]), width_[0],
                      width_[0] * width_[1]);
}

void Samples::mark(int s, double value, double* values) const {
  const double *x = factors(s), *y = x + width_[0], *z = y + width_[1];
  values += begin(s);
  for (int k = 0; k < width_[2]; ++k)
    for (int j = 0; j < width_[1]; ++j)
      for (int i = 0; i < width_[0]; ++i)
        if (of_nodes() || x[i] * y[j] * z[k] != 0) values[i + counts_[0] * (j + counts_[1] * k)] = value;
}

void Samples::add(int s, double factor, const double* of_s, double* values) const { add(s, &factor, of_s, values, 1, 0); }

void Samples::add(int s, const Vec3& factor, const double* of_s, Points& values) const {
  add(s, factor.data(), of_s, values.data(), 3, values.rows());
}

void Samples::add(int s, const double* factor, const double* of_s, double* values, int columns, std::ptrdiff_t column) const {
  const int line = counts_[0], layer = counts_[0] * counts_[1];
  values += begin(s);
  if (width_[0] == 4) return kernels::add_lines_here(factor, of_s, values, width_[1], line, width_[2], layer, columns, column);
  for (int k = 0; k < width_[2]; ++k)
    for (int j = 0; j < width_[1]; ++j, of_s += width_[0])
      for (int c = 0; c < columns; ++c) {
        double* at = values + j * line + k * layer + c * column;
        for (int i = 0; i < width_[0]; ++i) at[i] += factor[c] * of_s[i];
      }
}

}  // namespace softffd
