#include "forces/solid.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "model/arithmetic.hpp"
#include "model/lobatto.hpp"

namespace softffd {

namespace {

/// Largest eigenvalues for a line of four nodes of length 1: of the squared derivative, 42 + sqrt 1044, and of its projection squared.
constexpr double steepest = 74.310988842807021, divergent = 60;

kernels::PatchShape shape_of(const std::array<double, 3>& sides) {
  kernels::PatchShape shape{.y = kernels::LineShape(sides[1]), .z = kernels::LineShape(sides[2])};
  for (int i = 0; i < 4; ++i)
    for (int s = 0; s < 4; ++s) {
      const double d = lobatto::derivative[i][s];
      shape.along[s][i] = shape.back[i][s] = d / sides[0];
      shape.across[0][i][s] = d / sides[1];
      shape.across[1][i][s] = d / sides[2];
      const double x_i = 2 * lobatto::places[i] - 1, x_s = 2 * lobatto::places[s] - 1;
      shape.projector[s][i] = lobatto::weights[s] * (1 + 3 * x_i * x_s);
    }
  const auto& w = lobatto::weights;
  for (int r = 0; r < 16; ++r)
    for (int i = 0; i < 4; ++i) shape.weight[r][i] = w[i] * w[r % 4] * w[r / 4] * (sides[0] * sides[1] * sides[2]);
  return shape;
}

/// Returns the derivative l_i'(u) of the polynomial of node i.
double slope_of(int i, double u) {
  double sum = 0;
  for (int j = 0; j < lobatto::nodes; ++j) {
    double product = j == i ? 0 : 1 / (lobatto::places[i] - lobatto::places[j]);
    for (int k = 0; k < lobatto::nodes; ++k)
      if (k != i && k != j) product *= (u - lobatto::places[k]) / (lobatto::places[i] - lobatto::places[k]);
    sum += product;
  }
  return sum;
}

}  // namespace

SolidPlace::SolidPlace(const Lattice& lattice, const Vec3& at) {
  for (int a = 0; a < 3; ++a) {
    const int count = lobatto::patches(lattice.counts[a]);
    const double t = (at[a] - lattice.origin[a]) / lattice.size[a];
    patch[a] = std::clamp(int(std::floor(t * count)), 0, count - 1);
    const double u = t * count - patch[a];
    const Scalars values = lobatto::interpolation(u, lobatto::nodes);
    for (int i = 0; i < lobatto::nodes; ++i) {
      value[a][i] = values[i];
      slope[a][i] = slope_of(i, u) * (count / lattice.size[a]);
    }
    from_middle[a] = 2 * u - 1;
  }
}

double MaterialState::von_mises() const {
  const Mat3 shape = stress - stress.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5 * shape.squaredNorm());
}

double MaterialState::largest_stretch() const {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Mat3>(gradient.transpose() * gradient, Eigen::EigenvaluesOnly).eigenvalues()[2]);
}

MaterialState Solid::at(const SolidPlace& place, const Points& x) const {
  MaterialState state{Mat3::Zero(), Mat3::Constant(std::numeric_limits<double>::quiet_NaN())};
  const int first = 3 * lattice_.index(place.patch[0], place.patch[1], place.patch[2]);
  double volumes[64], projected = 0;
  kernels::patch_volumes(body_, x.data() + first, volumes);
  for (int g = 0; g < 64; ++g) {
    const std::array<int, 3> node{g % 4, g / 4 % 4, g / 16};
    const Vec3 at_node = row(x, first + lattice_.index(node[0], node[1], node[2]));
    double weight = 1;
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      state.gradient.col(a) += place.slope[a][node[a]] * (place.value[b][node[b]] * place.value[c][node[c]]) * at_node;
      weight *= lobatto::weights[node[a]] * (1 + 3 * (2 * lobatto::places[node[a]] - 1) * place.from_middle[a]);
    }
    projected += weight * volumes[g];
  }
  const double volume = state.gradient.determinant(), missing = std::max(kernels::least_volume - volume, 0.0);
  if (!(volume > 0)) return state;
  const double pressure = body_.mu * (volume - 2) + body_.lambda * projected - body_.lambda / kernels::least_volume * missing * missing;
  state.stress = body_.mu / volume * state.gradient * state.gradient.transpose() + pressure * Mat3::Identity();
  return state;
}

Solid::Solid(const Lattice& lattice)
    : lattice_(lattice),
      edges_(lattice),
      rest_(rest_positions(lattice)),
      volume_(lobatto::volume_fractions(lattice) * lattice.size.prod()) {
  std::array<double, 3> sides;
  double squares = 0;
  for (int a = 0; a < 3; ++a) {
    body_.patches[a] = lobatto::patches(lattice.counts[a]);
    sides[a] = lattice.size[a] / body_.patches[a];
    squares += 1 / (sides[a] * sides[a]);
  }
  body_.points = lattice.points();
  body_.line = lattice.counts[0];
  body_.layer = lattice.counts[0] * lattice.counts[1];
  body_.shape = shape_of(sides);
  gradient_ = steepest * squares;
  divergence_ = divergent * squares;
  bounds_.resize(std::size_t(body_.patches[0]) * body_.patches[1] * body_.patches[2]);
}

void Solid::set_material(double modulus, double ratio, double time) {
  body_.mu = modulus / (2 * (1 + ratio));
  body_.lambda = modulus * ratio / ((1 + ratio) * (1 - 2 * ratio));
  time_ = time;
  if (!(time_ > 0) || kept_.size() > 0) return;
  kept_.resize(bounds_.size() * kernels::kept_numbers);
  keep_gradients(rest_);
}

void Solid::keep_gradients(const Points& x) const {
  kept_at_ = x;
  kernels::find_gradients(body_, x.data(), kept_.data());
}

void Solid::subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const {
  kernels::subtract_tangent(body_, of.softening, of.per_time * time_, x.data(), u.data(), f.data());
}

void Solid::add_blocks(const Points& x, const Linearisation& of, BlockSink& sink) const {
  if (!matrix_) matrix_ = std::make_unique<kernels::PatchMatrix>();
  const auto node = [&](int i) { return lattice_.index(i % 4, i / 4 % 4, i / 16); };
  for (int patch = 0; patch < int(bounds_.size()); ++patch) {
    const int at = first_node(patch);
    kernels::patch_matrix(body_, of.softening, of.per_time * time_, x.data() + at, *matrix_);
    for (int q = 0; q < 64; ++q)
      for (int p = q; p < 64; ++p) {
        Mat3 block;
        for (int c = 0; c < 3; ++c)
          for (int e = 0; e < 3; ++e) block(c, e) = matrix_->of[3 * c + e].at[q][p];
        sink.add(at + node(p), at + node(q), block);
      }
  }
}

double Solid::largest_stiffness() const { return (2 * body_.mu + body_.lambda) * gradient_ * volume_.maxCoeff(); }
double Solid::total_stiffness() const { return (2 * body_.mu + body_.lambda) * gradient_ * volume_.sum(); }

int Solid::first_node(int patch) const {
  const auto& n = body_.patches;
  return 3 * lattice_.index(patch % n[0], patch / n[0] % n[1], patch / n[0] / n[1]);
}

/// Returns the smallest ratio of mass to volume among the moving nodes of a patch [kg/m3].
double Solid::density(int patch, const Scalars& mass, const std::vector<bool>& pinned) const {
  double least = infinity;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        if (const int p = first_node(patch) + lattice_.index(i, j, k); !pinned[p]) least = std::min(least, mass[p] / volume_[p]);
  return least;
}

template <class Squared>
double Solid::largest(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, const Squared& squared) const {
  kernels::bound_patches(body_, x.data(), bounds_.data());
  double most = 0;
  for (std::size_t patch = 0; patch < bounds_.size(); ++patch)
    most = std::max(most, squared(bounds_[patch]) / density(int(patch), mass, pinned));
  return most;
}

double Solid::squared_frequency(const kernels::PatchBounds& bounds) const {
  const double volume = std::sqrt(gradient_ * bounds.unevenness) + std::sqrt(divergence_ * bounds.mean);
  return gradient_ * bounds.curvature + body_.lambda * (volume * volume);
}

/// Adds the bounds at rest, from which time scales follow.
void Solid::add_any_bounds(const Scalars& mass, const std::vector<bool>& pinned, AnyBounds& bounds) const {
  const double squared = largest(rest_, mass, pinned, [&](const auto& patch) { return squared_frequency(patch); });
  for (Scalars* each : {&bounds.weighted, &bounds.plain}) *each += squared * mass;
  bounds.exist = false;
}

bool Solid::add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const {
  const double squared = largest(x, mass, pinned, [&](const auto& patch) { return squared_frequency(patch); });
  for (int axis = 0; axis < 3; ++axis) sums.segment(axis * mass.size(), mass.size()) += squared * mass;
  return true;
}

double Solid::dashpot_rate(const Points& x, const Scalars& mass, const std::vector<bool>& pinned) const {
  return time_ * largest(x, mass, pinned, [&](const auto& patch) {
           const double volume = std::sqrt(gradient_ * patch.of_stretch) + std::sqrt(divergence_ * patch.average);
           return 2 * body_.mu * gradient_ * patch.stretch + body_.lambda * (volume * volume);
         });
}

int Solid::folded_cells(const Points& x) const {
  int count = 0;
  for (int patch = 0; patch < int(bounds_.size()); ++patch) {
    double volumes[64];
    kernels::patch_volumes(body_, x.data() + first_node(patch), volumes);
    for (int cell = 0; cell < 27; ++cell) {
      const double* lower = volumes + cell % 3 + 4 * (cell / 3 % 3) + 16 * (cell / 9);
      bool folded = false;
      for (int corner = 0; corner < 8; ++corner) folded = folded || lower[(corner & 1) + 4 * (corner >> 1 & 1) + 16 * (corner >> 2)] <= -1;
      count += folded;
    }
  }
  return count;
}

double Solid::swing(const Points& x, const Points& v, const Swing& by) const {
  LargestSwing largest(by);
  edges_.visit([&](int p, int q) { largest.consider(p, q, (row(rest_, q) - row(rest_, p)).norm(), x, v); });
  return largest.value();
}

void Solid::add_force(const Points& x, Points& f) const {
  if (time_ > 0) kept_at_ = x;
  kernels::subtract_elastic(body_, x.data(), f.data(), time_ > 0 ? kept_.data() : nullptr);
}

/// Uses the gradients kept for x if there are any: a step asks for several dashpot forces at the same positions.
void Solid::add_dashpot_force(const Points& x, const Points& v, Points& f, double drift) const {
  if (!(time_ > 0)) return;
  if (std::memcmp(kept_at_.data(), x.data(), x.size() * sizeof(double)) != 0) keep_gradients(x);
  kernels::subtract_viscous(body_, time_, drift, kept_.data(), v.data(), f.data());
}

double Solid::dashpot_power(const Points& x, const Points& v) const {
  return time_ > 0 ? time_ * kernels::viscous_power(body_, x.data(), v.data()) : 0;
}

}  // namespace softffd
