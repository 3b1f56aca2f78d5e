#include "kit/limits.hpp"

#include "kit/outlook.hpp"
#include "kit/tumbling.hpp"

#include <algorithm>
#include <cmath>

#include "body/rigid_motion.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

/// A run is long if its length times omega is above this [rad]: near the end of its stability interval rkn12 takes a millionth of a
/// vibration's energy per step, which adds up. In long runs its steps are shorter by the factor in its row of traits.cpp.
constexpr double long_run = 1e5;
/// Largest (omega h) (spin h) of an implicit step [1]: points go along straight lines, which stretches springs, and the energy of the
/// rotation errs by about the square of this product. By experience on spinning bodies.
constexpr double straight_turn = 1e-4;
/// Largest angle that such a step may turn through, however soft the body [rad]: the torque on turning pins errs as its cube.
constexpr double straight_angle = 0.005;
/// Largest angle that a step in the body's own frame may turn through [rad]: the rigid motion is exact, but the directions of the loads in
/// the frame are interpolated linearly.
constexpr double frame_angle = 1;
/// Largest product of step and rate of damping where dashpots act on free parts [1].
constexpr double part_damping = 0.8;
/// Steps in contact of a surface of many vertices are not cut below a fraction of the stable step [1]. The fraction goes with the square
/// root of the tolerance: least_of_surface at a tolerance as large as the box, most_of_surface at most. Which vertex comes down first
/// decides there, and shorter steps hardly tell that better. Measured on sixty cubes that drop or rest, flat and tilted, at a tolerance of
/// 1e-4: 2.8 tolerances in the mean with 1/1000, 2.3 with 1/125. Smaller tolerances may be met by shorter steps.
constexpr double least_of_surface = 0.8, most_of_surface = 1.0 / 32;

/// Largest of many differences relative to their root mean square [1].
constexpr double farthest = 3.5;

}  // namespace thresholds

namespace {

/// Step of leapfrog with dashpots [s]: a shorter one that carries velocities on for the dashpots, if that takes less work than the longest.
double with_dashpots(const StepContext& context, double longest) {
  const auto work = [&](double h) { return step_work(context.model.body, context.drive, context.run, Method::leapfrog, h) / h; };
  bound(context);
  const double carried = longest_carried(context.drive, context.run);
  return 0 < carried && carried < longest && work(carried) < work(longest) ? carried : longest;
}

/// Number of sub-intervals of this length [s] whose errors remain at the end of the run, if damping forgets errors within `lasts` [s].
double stretches_in(const StepContext& context, double lasts, double stretch) {
  return std::max(1.0, std::min(context.request.horizon, lasts) / stretch);
}

double spin(const Model& model, const Points& x, const Points& v) { return rigid_motion(model.body.mass, x, v).spin.norm(); }

}  // namespace

double bound(const StepContext& context) {
  ControllerState& control = context.run.control;
  if (control.bound < 0 || deformed_since_bound(context)) {
    const Body& body = context.model.body;
    control.bound = context.model.stability.frequency(body, context.run.physical.motion.x);
    control.damping_bound = body.damping_rate_at(context.run.physical.motion.x);
    control.bound_x.change() = context.run.physical.motion.x;
  }
  return control.bound;
}

double damping_bound(const StepContext& context) {
  bound(context);  // both bounds are renewed at the same moments
  return context.run.control.damping_bound;
}

bool deformed_since_bound(const StepContext& context) {
  return context.model.body.has_deformed(context.run.physical.motion.x, *context.run.control.bound_x);
}

double step_limit(const StepContext& context, Method method, bool given) {
  double limit = infinity;
  const Traits& t = traits(method);
  const State& motion = context.run.physical.motion;
  if (context.model.stability.elastic()) limit = (given ? t.given : t.automatic) * 2 / bound(context);
  if (!given && t.long_run < 1 && context.request.horizon * bound(context) > thresholds::long_run) limit *= t.long_run;
  if (!given && method == Method::leapfrog && context.model.body.dashpots()) {
    limit = with_dashpots(context, limit);
    // the kicks of the parts do not solve for the forces of the dashpots on them
    if (std::ranges::any_of(context.drive.free, &FreeMotion::part))
      limit = std::min(limit, thresholds::part_damping / damping_bound(context));
  }
  if (t.damping < infinity) limit = std::min(limit, t.damping / damping_bound(context));
  if (!given && t.turning == Turning::straight) limit = tighter(limit, turning_limit(context, motion.x, motion.v));
  if (!given && t.turning == Turning::in_frame)
    limit = tighter(thresholds::stiffest / bound(context), thresholds::frame_angle / spin(context.model, motion.x, motion.v));
  return limit * context.request.step_factor;
}

double shortest_in_contact(const StepContext& context, double limit) {
  const Body& body = context.model.body;
  double fraction = thresholds::least_doubled;
  if (body.samples) {
    const double of_tolerance = thresholds::least_of_surface * std::sqrt(context.request.tolerance / body.length);
    fraction = std::clamp(of_tolerance, thresholds::least_doubled, thresholds::most_of_surface);
  }
  return fraction * limit;
}

double turning_limit(const StepContext& context, const Points& x, const Points& v) {
  double fastest = spin(context.model, x, v);
  for (const FreeMotion& each : context.drive.free) fastest = worse(fastest, each.spin(each.state()).norm());
  for (const Pin& pin : context.drive.pins) fastest = worse(fastest, pin.at(context.run.physical.motion.time).spin.norm());
  return tighter(thresholds::stiffest / bound(context),
                 tighter(std::sqrt(thresholds::straight_turn / (bound(context) * fastest)), thresholds::straight_angle / fastest));
}

double position_rounding(const StepContext& context) {
  const Points& x = context.run.physical.motion.x;
  return thresholds::rounding * std::max(context.model.body.length, kernels::largest(x.size(), x.data()));
}

double rounding_by_end(const StepContext& context) {
  const double place = position_rounding(context);
  return context.drive.held() ? place : place * (1 + left_of_run(context) * bound(context));
}

double growing(const StepContext& context, const State& a, const State& b, double stretch) {
  const Scalars &time_scale = context.model.time_scale, &memory = context.model.memory;
  const auto times = [&](double lasts) { return stretches_in(context, lasts, stretch); };
  const double same = position_rounding(context);
  double error = worse(free_bodies_apart(context, a, b, true), drifted_apart(context, a, b)) * times(infinity);
  for (int i = 0; i < memory.size(); ++i) {
    const double dx = std::abs(a.x.data()[i] - b.x.data()[i]), dv = std::abs(a.v.data()[i] - b.v.data()[i]) * time_scale[i];
    if (!(dx < infinity && dv < infinity)) return infinity;
    error = std::max(error, std::max(dx - same, dv) * times(memory[i]));
  }
  return error;
}

double scattered(const StepContext& context, const State& a, const State& b, double stretch) {
  const Model& model = context.model;
  const int n = model.body.points();
  double most = 0, squares = 0;
  int moving = 0;
  for (int i = 0; i < 3 * n; ++i) {
    if (model.body.pinned[i % n]) continue;
    const double dx = std::abs(a.x.data()[i] - b.x.data()[i]), dv = std::abs(a.v.data()[i] - b.v.data()[i]);
    if (!(dx < infinity && dv < infinity)) return infinity;
    const double lasting = std::max(dx, std::min(dv, thresholds::way_of_velocity * dx / stretch) * model.time_scale[i]);
    most = std::max(most, lasting);
    squares += lasting * lasting;
    ++moving;
  }
  const double spread = std::min(thresholds::farthest * std::sqrt(squares / std::max(moving, 1)), most);
  const double error = std::max(most, spread * std::sqrt(stretches_in(context, model.longest_memory, stretch)));
  return worse(error, free_bodies_apart(context, a, b, true) * stretches_in(context, infinity, stretch));
}

}  // namespace softffd
