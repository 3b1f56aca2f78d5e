#include "contact/free/isolated.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "model/arithmetic.hpp"

namespace softffd {

bool Isolated::is(const Equations& equations) {
  const auto& [body, around] = equations;
  const auto own = [](const auto& each) { return bool(each.own); };
  return !around.free.empty() && !(body.damping > 0).any() && std::ranges::all_of(around.planes, own) &&
         std::ranges::all_of(around.pins, own) &&
         std::ranges::none_of(around.free, [](const FreeMotion& each) { return each.body().guided(); });
}

void Isolated::begin(const Equations& equations, const State& state) {
  equations_ = &equations;
  momentum_ = whole(state.x, &state.v, state.free).momentum;
}

void Isolated::add(double weight, const Points& force, const Points& x, const std::vector<FreeState>& free) {
  const Vec3 centre = whole(x, nullptr, free).centre;
  for (int p = 0; p < x.rows(); ++p) momentum_ += weight * (row(x, p) - centre).cross(row(force, p));
  for (const FreeMotion& each : equations_->around.free) {
    const FreeState& state = free[each.index()];
    const auto [load, torque] = each.loads(state);
    momentum_ += weight * ((state.position - centre).cross(load) + torque);
  }
}

double Isolated::give_back(const Points& x, Points& v, std::vector<FreeState>& free) const {
  const Whole now = whole(x, &v, free);
  const Vec3 lack = momentum_ - now.momentum, spin = now.inertia.inverse() * lack;
  for (int p = 0; p < x.rows(); ++p) set_row(v, p, row(v, p) + spin.cross(row(x, p) - now.centre));
  for (const FreeMotion& each : equations_->around.free) {
    FreeState& state = free[each.index()];
    state.velocity += spin.cross(state.position - now.centre);
    state.momentum += each.inertia(state) * spin;
  }
  return spin.dot(now.momentum + 0.5 * lack);
}

/// The mass of a part includes the points that it holds.
Isolated::Whole Isolated::whole(const Points& x, const Points* v, const std::vector<FreeState>& free) const {
  const auto& [body, around] = *equations_;
  const auto each_point = [&](auto see) {
    for (int p = 0; p < x.rows(); ++p)
      if (!body.pinned[p]) see(body.mass[p], row(x, p), v ? row(*v, p) : Vec3(Vec3::Zero()));
    for (const FreeMotion& each : around.free) see(each.mass(), free[each.index()].position, free[each.index()].velocity);
  };
  double mass = 0;
  Whole all{Vec3::Zero(), Vec3::Zero(), Eigen::Matrix3d::Zero()};
  each_point([&](double m, const Vec3& place, const Vec3&) { mass += m, all.centre += m * place; });
  all.centre /= mass;
  if (!v) return all;
  each_point([&](double m, const Vec3& place, const Vec3& velocity) {
    const Vec3 arm = place - all.centre;
    all.momentum += m * arm.cross(velocity);
    all.inertia += m * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  });
  for (const FreeMotion& each : around.free) {
    all.momentum += free[each.index()].momentum;
    all.inertia += each.inertia(free[each.index()]);
  }
  return all;
}

}  // namespace softffd
