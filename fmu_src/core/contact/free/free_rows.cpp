#include "contact/free/free_rows.hpp"

#include <Eigen/Dense>

namespace softffd {

namespace {

/// Returns the matrix [arm]x, for which [arm]x v = arm x v.
Eigen::Matrix3d cross(const Vec3& arm) {
  Eigen::Matrix3d matrix;
  matrix << 0, -arm[2], arm[1], arm[2], 0, -arm[0], -arm[1], arm[0], 0;
  return matrix;
}

}  // namespace

void FreeRows::set_bodies(const Drive& around, const std::vector<FreeState>& states, const Points& x, double scale, bool pins) {
  around_ = &around;
  states_ = &states;
  x_ = &x;
  known_.clear();
  yields_.clear();
  body_of_.assign(around.planes.size(), -1);
  pins_ = false;
  for (const FreeMotion& each : around.free) {
    yields_.push_back({scale * each.inverse_mass(), scale * each.inverse_inertia(states[each.index()])});
    if (each.body().plane >= 0) body_of_[each.body().plane] = each.index();
    pins_ = pins_ || (pins && each.body().pin >= 0);
  }
  clear_twists();
}

void FreeRows::clear_twists() {
  twists_.assign(yields_.size(), {});
  given_.assign(yields_.size(), {});
}

const Handles& FreeRows::handles(const SurfaceRow& row) {
  if (int(known_.size()) <= row.plane) known_.resize(row.plane + 1);
  Known& known = known_[row.plane];
  if (known.sample != row.sample) known = {row.sample, find_handles(row)};
  return known.handles;
}

Handles FreeRows::find_handles(const SurfaceRow& row) const {
  const int sample = row.sample;
  Handles found;
  if (const int k = body_of_[(*obstacles_)[row.plane]]; k >= 0) found.push_back({k, -1, (*states_)[k].position - place_of(row)});
  if (!samples_->of_object(sample)) {
    if (const int k = body_of_[solid_of(*samples_, row.sample)]; k >= 0) found.push_back({k, 1, place_of(row) - (*states_)[k].position});
    return found;
  }
  if (!pins_) return found;
  std::vector<double> weights(samples_->support());
  Scalars of_points = Scalars::Zero(x_->rows());
  samples_->weights(sample, Scalars::Ones(x_->rows()), weights.data());
  samples_->add(sample, 1, weights.data(), of_points.data());
  for (const FreeMotion& each : around_->free) {
    if (each.body().pin < 0) continue;
    Handle handle{.body = each.index()};
    for (const int p : around_->pins[each.body().pin].points) {
      handle.weight += of_points[p];
      handle.arm += of_points[p] * (softffd::row(*x_, p) - (*states_)[each.index()].position);
    }
    if (handle.weight != 0 || !handle.arm.isZero(0)) found.push_back(handle);
  }
  return found;
}

Eigen::Matrix3d FreeRows::between(const Handles& a, const Handles& b) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Handle& one : a)
    for (const Handle& other : b) {
      if (one.body != other.body) continue;
      const auto& [mass, inertia] = yields_[one.body];
      sum += one.weight * other.weight * mass + cross(one.arm).transpose() * inertia * cross(other.arm);
    }
  return sum;
}

void FreeRows::find_twists(const std::vector<Handles>& handles, const std::vector<Vec3>& forces) {
  clear_twists();
  for (std::size_t t = 0; t < forces.size(); ++t)
    for (const Handle& each : handles[t]) add(each, forces[t]);
}

void FreeRows::set_given(const std::vector<Wrench>& given) {
  given_ = given;
  for (std::size_t k = 0; k < yields_.size(); ++k) twists_[k] = {yields_[k].mass * given[k].force, yields_[k].inertia * given[k].torque};
}

void FreeRows::add_force(const SurfaceRow& row, const Vec3& force) {
  for (const Handle& each : handles(row)) add(each, force);
}

void FreeRows::add(const Handle& handle, const Vec3& force) {
  Wrench& given = given_[handle.body];
  given.force += handle.weight * force;
  given.torque += handle.arm.cross(force);
  const auto& [mass, inertia] = yields_[handle.body];
  twists_[handle.body] = {mass * given.force, inertia * given.torque};
}

void FreeRows::move_pins(Points& move) const {
  if (!pins_) return;
  for (const FreeMotion& each : around_->free) {
    if (each.body().pin < 0) continue;
    const Vec3& centre = (*states_)[each.index()].position;
    for (const int p : around_->pins[each.body().pin].points) set_row(move, p, twists_[each.index()].at(row(*x_, p) - centre));
  }
}

Vec3 FreeRows::parting(const SurfaceRow& row) const {
  const int k = body_of_[(*obstacles_)[row.plane]];
  if (k < 0) return motion_of_solid(row);
  return -twists_[k].at(place_of(row) - (*states_)[k].position);
}

Vec3 FreeRows::motion_of_solid(const SurfaceRow& row) const {
  if (samples_->of_object(row.sample)) return Vec3::Zero();
  const int k = body_of_[solid_of(*samples_, row.sample)];
  if (k < 0) return Vec3::Zero();
  return twists_[k].at(place_of(row) - (*states_)[k].position);
}

/// f = -G^-1 (away + J t) with the twists t = Y J' f, so that (1 + Y J' G^-1 J) t = -Y J' G^-1 away. J: handles; Y: yields.
void FreeRows::stick(const std::vector<Handles>& handles, const std::vector<Vec3>& away, const std::function<void(double*)>& solve,
                     std::vector<Vec3>& forces) const {
  const std::size_t n = handles.size(), bodies = yields_.size();
  std::vector<double> columns(4 * n);
  forces.resize(n);
  for (std::size_t a = 0; a < n; ++a) Eigen::Map<Eigen::Vector4d>(&columns[4 * a]) << away[a], 0;
  solve(columns.data());
  for (std::size_t a = 0; a < n; ++a) forces[a] = -Vec3(columns[4 * a], columns[4 * a + 1], columns[4 * a + 2]);
  std::vector<std::vector<Handle>> responses(bodies);  // G^-1 times the columns of `weight` and `arm`
  for (std::size_t k = 0; k < bodies; ++k) {
    for (std::size_t a = 0; a < n; ++a) {
      const Handle own = handle_on(int(k), handles[a]);
      Eigen::Map<Eigen::Vector4d>(&columns[4 * a]) << own.arm, own.weight;
    }
    solve(columns.data());
    for (std::size_t a = 0; a < n; ++a)
      responses[k].push_back({int(k), columns[4 * a + 3], Vec3(columns[4 * a], columns[4 * a + 1], columns[4 * a + 2])});
  }
  const int size = 6 * int(bodies);
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  for (std::size_t a = 0; a < n; ++a)
    for (const Handle& each : handles[a]) {
      right.segment<3>(6 * each.body) += each.weight * forces[a];
      right.segment<3>(6 * each.body + 3) += each.arm.cross(forces[a]);
      for (int c = 0; c < size; ++c) {
        const Vec3 moved = motion(responses[c / 6][a], c % 6);
        slope.block<3, 1>(6 * each.body, c) += each.weight * moved;
        slope.block<3, 1>(6 * each.body + 3, c) += each.arm.cross(moved);
      }
    }
  for (std::size_t k = 0; k < bodies; ++k)
    for (const int at : {0, 3}) {
      const Eigen::Matrix3d& yield = at == 0 ? yields_[k].mass : yields_[k].inertia;
      right.segment<3>(6 * k + at) = (yield * right.segment<3>(6 * k + at)).eval();
      slope.middleRows<3>(6 * k + at) = (yield * slope.middleRows<3>(6 * k + at)).eval();
    }
  slope.diagonal().array() += 1;
  const Eigen::VectorXd twist = slope.partialPivLu().solve(right);
  for (std::size_t a = 0; a < n; ++a)
    for (int c = 0; c < size; ++c) forces[a] -= twist[c] * motion(responses[c / 6][a], c % 6);
}

}  // namespace softffd
