#include "watch/means.hpp"

#include <algorithm>
#include <cmath>

#include "contact/tolerances.hpp"

namespace softffd {

namespace thresholds {

/// Forces must move a point in a communication step by this multiple of rounding for means of the step alone [1].
constexpr double known_means = 10;
/// The same for means over several steps, at whose end contact gives an impulse: it has given dozens by then [1].
constexpr double common_means = 100;
/// The same if contact gives no impulse: none is due [1].
constexpr double without_contact = 200;
/// Impulses that differ from those of the means before by this multiple of what forces give are not hidden [1]: both may be as large.
constexpr double given_by_forces = 2;
/// Means of pins are over at least this multiple of rounding of the clock [1].
constexpr double pin_means = 1e4;

}  // namespace thresholds

namespace {

/// True if an obstacle pushes the body, did so before, or touches it.
bool may_push(const Run& run) {
  const auto pushes = [](const auto& on) { return !on.force.isZero(0); };
  return std::ranges::any_of(run.physical.exchange.planes, pushes) || std::ranges::any_of(run.plane_reactions, pushes) ||
         std::ranges::any_of(run.contacts, [](Count count) { return count > 0; });
}

}  // namespace

HiddenForces hidden_forces(const Equations& equations, const Run& run, double H) {
  const auto& [body, drive] = equations;
  if (drive.planes.empty()) return {};
  const State& motion = run.physical.motion;
  const double hidden = rounding * motion.x.abs().maxCoeff();  // [m]
  double fastest = 0, sum = 0, mass = 0;                       // acceleration [m/s2], force [N], mass [kg]
  for (int p = 0; p < body.points(); ++p) {
    if (body.pinned[p]) continue;
    const double force = (row(motion.spring, p) + row(drive.force, p)).norm();
    sum += force;
    mass += body.mass[p];
    fastest = std::max(fastest, force / body.mass[p]);
    if (run.hidden == 0 && !(fastest * H * H < thresholds::known_means * hidden)) return {};
  }
  for (const FreeMotion& each : drive.free) {
    sum += each.loads(each.state()).force.norm();
    mass += each.own_mass();
  }
  if (!(sum > 0)) return {};
  const double most = thresholds::given_by_forces * (run.hidden + sum * H) + mass * thresholds::known_means * hidden / H;
  return {sum, most, fastest * H * (H + run.hidden / sum) / hidden};
}

double time_of_means(const HiddenForces& forces, const Run& before, bool first, double H, Run& run) {
  if (forces.way < 0) {
    run.hidden = 0;
    return H;
  }
  const double time = H + run.hidden / forces.sum;
  bool at_once = false, pushed = false;
  for (std::size_t q = 0; q < run.plane_reactions.size(); ++q) {
    const Vec3& impulse = run.physical.exchange.planes[q].force;
    at_once = at_once || !((impulse - run.plane_reactions[q].force * time).norm() <= forces.most);
    pushed = pushed || impulse != before.physical.exchange.planes[q].force;
  }
  const bool waits = may_push(run) && !at_once &&
                     forces.way < (run.hidden == 0 ? thresholds::known_means
                                   : pushed        ? thresholds::common_means
                                                   : thresholds::without_contact);
  run.hidden = waits ? run.hidden + forces.sum * H : 0;
  if (waits && !first) return 0;
  return at_once ? H : time;
}

void take_means_of_pins(double H, Run& run) {
  run.pin_time += H;
  if (run.pin_time < thresholds::pin_means * rounding * std::abs(run.physical.motion.time)) return;
  for (std::size_t a = 0; a < run.pin_reactions.size(); ++a) run.pin_reactions[a] = run.physical.exchange.pins[a].mean(run.pin_time);
  run.pin_time = 0;
}

}  // namespace softffd
