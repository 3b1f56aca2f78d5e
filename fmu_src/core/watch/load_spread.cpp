#include "watch/load_spread.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

namespace {

/// If what remains of a sample's product of weights is below `same` times the largest, the sample is a combination of those before. `weak`
/// times the trace is added to the diagonal of a matrix, which keeps weak fields out.
constexpr double same = 1e-12, weak = 1e-12;
/// Relative residual of the control points' forces that is small enough; above `failed` the distribution is not taken.
constexpr double done = 1e-11, failed = 1e-6;
/// Distance of a grid's nodes in cells of the lattice, for spreading forces: a little more than the widest distance of a patch's nodes.
constexpr double wide = 1.5;
constexpr int most_rounds = 20, balance_rounds = 6;

/// Adds the missing sum to the forces, in proportion to the weights.
void complete(const Scalars& weight, const Vec3& missing, Points& forces) {
  forces.matrix() += (weight / weight.sum()).matrix() * missing.transpose();
}

}  // namespace

void DistributedLoad::take(const std::vector<Touch>& touches) {
  const int count = int(touches.size());
  samples.resize(count);
  touching.resize(count);
  for (Scalars* each : {&area, &along}) each->resize(count);
  for (Points* each : {&place, &normal, &across}) each->resize(count, 3);
  for (int t = 0; t < count; ++t) {
    const Touch& each = touches[t];
    samples[t] = each.at;
    touching[t] = each.touches;
    area[t] = each.area;
    along[t] = std::max(each.normal.dot(each.force), 0.0);
    set_row(place, t, each.place);
    set_row(normal, t, each.normal);
    set_row(across, t, each.force - along[t] * each.normal);
  }
}

void LoadSpread::distribute(DistributedLoad& load) {
  if (load.count() < 2 || !(load.along.sum() > 0) || !(load.area.minCoeff() > 0)) return;
  Vec3 sum = Vec3::Zero();
  for (int t = 0; t < load.count(); ++t) sum += load.force(t);
  distribute_touching(load);
  smooth(load);
  for (int t = 0; t < load.count(); ++t) sum -= load.force(t);
  complete(load.along, sum, load.across);
}

void LoadSpread::distribute_touching(DistributedLoad& load) {
  chosen_.clear();
  std::vector<int> samples;
  for (int t = 0; t < load.count(); ++t)
    if (load.touching[t]) chosen_.push_back(t), samples.push_back(load.samples[t]);
  if (samples.size() < 2) return;
  if (samples != touching_) {
    touching_ = std::move(samples);
    find_fields();
  }
  Scalars forces = load.along(chosen_);
  Points rest = load.across(chosen_, Eigen::all);
  if (!along(load.area(chosen_), forces)) return;
  load.along(chosen_) = forces;
  if (across(forces, rest)) load.across(chosen_, Eigen::all) = rest;
}

/// Computes fields_ by Cholesky's factorization with pivoting.
void LoadSpread::find_fields() {
  const int count = int(touching_.size());
  const Scalars once = Scalars::Ones(samples_.lattice().points());
  Scalars weights(samples_.support()), left(count), column(count);
  for (int t = 0; t < count; ++t) {
    samples_.weights(touching_[t], once, weights.data());
    left[t] = samples_.product(touching_[t], touching_[t], weights.data());
  }
  const double least = same * left.maxCoeff();
  fields_.resize(count, 0);
  int rank = 0;
  for (Eigen::Index pivot; rank < count && left.maxCoeff(&pivot) > least; ++rank) {
    if (rank == fields_.cols()) fields_.conservativeResize(count, std::min(count, std::max(16, 2 * rank)));
    samples_.weights(touching_[pivot], once, weights.data());
    for (int t = 0; t < count; ++t) column[t] = samples_.product(touching_[t], touching_[pivot], weights.data());
    column.matrix() -= fields_.leftCols(rank) * fields_.row(pivot).head(rank).transpose();
    fields_.col(rank) = column / std::sqrt(left[pivot]);
    left -= fields_.col(rank).array().square();
    left[pivot] = 0;
  }
  fields_.conservativeResize(count, rank);
}

void LoadSpread::factor(const Scalars& weight) {
  Eigen::MatrixXd matrix = fields_.transpose() * weight.matrix().asDiagonal() * fields_;
  matrix.diagonal().array() += weak * matrix.trace();
  factor_.compute(matrix);
}

/// Distributes the parts along the normals. Returns false if there is no such distribution, or none was found.
bool LoadSpread::along(const Scalars& area, Scalars& forces) {
  const double sum = forces.sum();
  const Eigen::VectorXd wanted = fields_.transpose() * forces.matrix();
  Eigen::VectorXd y = Eigen::VectorXd::Zero(fields_.cols()), missing = wanted;
  Scalars pressure = Scalars::Ones(area.size()), found;  // at first all samples push
  for (int round = 0; round < most_rounds && missing.norm() > done * wanted.norm(); ++round) {
    factor((pressure > 0).select(area, 0.0));
    y += factor_.solve(missing);
    pressure = (fields_ * y).array();
    found = area * pressure.max(0.0);
    missing = wanted - fields_.transpose() * found.matrix();
  }
  if (!(missing.norm() <= failed * wanted.norm()) || !(found.sum() > 0)) return false;
  forces = (sum / found.sum()) * found;
  return true;
}

/// Distributes the other parts of the forces, of any sign, in proportion to the weights. Returns false if the result is not finite.
bool LoadSpread::across(const Scalars& weight, Points& forces) {
  const Eigen::MatrixXd wanted = fields_.transpose() * forces.matrix();
  factor(weight);
  Eigen::MatrixXd y = factor_.solve(wanted);
  for (int again = 0; again < 2; ++again) y += factor_.solve(wanted - fields_.transpose() * (weight.matrix().asDiagonal() * (fields_ * y)));
  Points found = (fields_ * y).array().colwise() * weight;
  complete(weight, (forces - found).colwise().sum().matrix().transpose(), found);
  if (!found.allFinite()) return false;
  forces = found;
  return true;
}

/// Finds the nodes of both grids around the rest place of each sample, and their weights.
void LoadSpread::find_hats(const DistributedLoad& load) {
  const Lattice& lattice = samples_.lattice();
  hats_.resize(load.count());
  std::array<int, 3> intervals, sides;
  for (int axis = 0; axis < 3; ++axis) {
    intervals[axis] = std::max(1, int(std::ceil((lattice.counts[axis] - 1) / wide)));
    sides[axis] = intervals[axis] + 2;
  }
  const int of_grid = sides[0] * sides[1] * sides[2];
  nodes_ = 2 * of_grid;
  for (int t = 0; t < load.count(); ++t) {
    const Vec3 part = (samples_.place(load.samples[t]) - lattice.origin).cwiseQuotient(lattice.size);
    for (const int grid : {0, 1}) {
      std::array<int, 3> first;
      std::array<std::array<double, 2>, 3> parts;
      for (int axis = 0; axis < 3; ++axis) {
        const double at = part[axis] * intervals[axis] + 0.5 * grid;
        first[axis] = std::clamp(int(at), 0, intervals[axis]);
        const double behind = std::clamp(at - first[axis], 0.0, 1.0);
        parts[axis] = {1 - behind, behind};
      }
      for (int corner = 0; corner < 8; ++corner) {
        const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
        const int node = first[0] + x + sides[0] * (first[1] + y + sides[1] * (first[2] + z));
        hats_[t].node[8 * grid + corner] = grid * of_grid + node;
        hats_[t].part[8 * grid + corner] = parts[0][x] * parts[1][y] * parts[2][z];
      }
    }
  }
}

/// Restricts values of the samples to the nodes of the grids and prolongs them back, columns side by side.
template <class Values>
Values LoadSpread::times(const Values& values) const {
  Values nodes = Values::Zero(nodes_, values.cols()), sums = Values::Zero(values.rows(), values.cols());
  for (int t = 0; t < values.rows(); ++t)
    for (int corner = 0; corner < 16; ++corner) nodes.row(hats_[t].node[corner]) += hats_[t].part[corner] * values.row(t);
  for (int t = 0; t < values.rows(); ++t)
    for (int corner = 0; corner < 16; ++corner) sums.row(t) += hats_[t].part[corner] * nodes.row(hats_[t].node[corner]);
  return sums;
}

void LoadSpread::smooth(DistributedLoad& load) {
  find_hats(load);
  Scalars balance = times(load.area).sqrt().inverse();
  for (int round = 0; round < balance_rounds; ++round) balance = (balance / times<Scalars>(load.area * balance)).sqrt();
  const Scalars kept = balance * times<Scalars>(load.area * balance);  // fraction kept of each force; 1 up to the residual of the rounds
  const Points pushed = load.normal.colwise() * load.along;
  const Vec3 facing = pushed.colwise().sum().matrix().transpose().normalized();
  const Eigen::Matrix<double, Eigen::Dynamic, 3> flat = load.place.matrix() * (Eigen::Matrix3d::Identity() - facing * facing.transpose());
  const Eigen::RowVector3d moment = load.along.matrix().transpose() * flat;
  Eigen::Array<double, Eigen::Dynamic, 4, Eigen::RowMajor> forces(load.count(), 4);
  forces << load.along, load.across;
  forces.colwise() *= balance / kept;
  forces = times(forces);
  forces.colwise() *= load.area * balance;
  load.along = forces.col(0);
  load.across = forces.rightCols(3);
  const double sum = load.along.sum();
  const Eigen::RowVector3d centre = load.along.matrix().transpose() * flat / sum;
  const Eigen::Matrix<double, Eigen::Dynamic, 3> arms = flat.rowwise() - centre;
  Eigen::Matrix3d inertia = arms.transpose() * load.along.matrix().asDiagonal() * arms;
  inertia.diagonal().array() += weak * inertia.trace();
  const Scalars factors = 1 + (arms * inertia.ldlt().solve((moment - sum * centre).transpose())).array();
  if (factors.minCoeff() > 0) load.along *= factors * (sum / (load.along * factors).sum());
}

}  // namespace softffd
