#include "methods/traits.hpp"

#include <algorithm>
#include <array>

#include "body/damped_kick.hpp"
#include "matrix/lattice_matrix.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace {

constexpr double any = infinity;

// Linear theory allows steps of 1 for leapfrog and of 2 for bm4 (measured: 2.4 is marginal). An automatic leapfrog step keeps
// omega h <= 1.36, clear of sqrt(3) and sqrt(2): there an undamped mode returns in phase with the springs' own nonlinearity every third or
// fourth step and gains energy without limit. The stability intervals of the Runge-Kutta methods on the imaginary axis are 8.3 (rkn12)
// and 5.9 (dop853). Near the end of its interval rkn12 takes a millionth of a vibration's energy per step, which matters in long runs. The
// work of bm4, rkn12 and dop853 is that of their force evaluations and of the combinations of stages, measured in force evaluations of
// leapfrog. `automatic` has the row of leapfrog, because with a given step it is leapfrog.
constexpr std::array<Traits, method_count> rows{{
    // method, order, work, given, automatic, long run, damping, tolerance: sum, step; contact, solves; turning, passes over vibrations,
    // staggered
    {Method::automatic, 2, 1.15, 0.98, 0.68, 1, any, 0, 0, true, false},
    {Method::central_difference, 2, 1.15, 0.98, 0.68, 1, any, 0, 0, true, false, Turning::free, false, true},
    {Method::leapfrog, 2, 1.15, 0.98, 0.68, 1, any, 0, 0, true, false, Turning::free, false, true},
    {Method::bm4, 4, 6.6, 1.96, 1.6, 1, 10, 0, 0, false, false},
    {Method::rkn12, 12, 20, 4.1, 3.9, 0.56, any, 5, 1, false, false},
    {Method::dop853, 8, 17, 2.9, 2.8, 1, 5, 6, 0.3, false, false},
    {Method::ros34pw2, 3, 0, any, any, 1, any, 40, 0.3, false, true, Turning::straight, true},
    {Method::backward_euler, 1, 150, any, any, 1, any, 0, 0, true, false, Turning::free, true},
    {Method::sdirk2, 2, 300, any, any, 1, any, 0, 0, true, false, Turning::free, true},
    {Method::floating_frame, 3, 0, any, any, 1, any, 40, 0.3, false, true, Turning::in_frame, true},
}};

/// Largest product of step and damping rate if velocities are carried on for the dashpots; stability allows 1 [1].
constexpr double stable_fraction = 0.8;

constexpr bool in_order() {
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].method != Method(i)) return false;
  return true;
}
static_assert(in_order());

}  // namespace

const Traits& traits(Method method) { return rows[std::size_t(method)]; }

bool takes_solid(Method method, const Lattice& lattice) {
  return method != Method::central_difference && (!is_implicit(method) || LatticeMatrix::exists(lattice));
}

/// Returns 0 beside obstacles, and if the frequency bound is not known. Returns 0 for counted steps, too: their result must not depend on
/// how time is divided, but it would if a step handed velocities on to the next.
double longest_carried(const Drive& around, const Run& run) {
  const bool known = run.control.bound >= 0, counted = run.physical.clock.unit > 0;
  return known && !counted && around.planes.empty() ? stable_fraction / run.control.damping_bound : 0;
}

bool carries_velocities(const Drive& around, const Run& run, double h) { return h <= (1 + 1e-9) * longest_carried(around, run); }

double step_work(const Body& body, const Drive& around, const Run& run, Method method, double h) {
  const double work = traits(method).work;
  if (method != Method::leapfrog || !body.dashpots()) return work;
  return work + (carries_velocities(around, run, h) ? 1 : 2 * DampedKick::products(body, 0.5 * h));
}

/// Measured with AVX2 instructions; right within a third for springs with 4 to 32 points per axis and for solids with 4 to 19, where the
/// matrices take most of the work that does not grow with the lattice. Solutions with a factor of 16 MB or more are limited by memory;
/// with contact they also compute the responses of the contact constraints. Conjugate gradients take 30 iterations of 3.3 to 3.8
/// evaluations each.
ImplicitWork::ImplicitWork(const Lattice& lattice) {
  if (!LatticeMatrix::has_factor(lattice)) {
    factor = 120;
    solution = 110;
    step = 8 + 4 * solution;
    return;
  }
  const Dissection order(lattice);
  const double per_point = 1.0 / lattice.points(), from_memory = order.solution_work() > 2e6 ? 2.5 : 1;
  factor = lattice.lobatto ? 200 + 0.01 * per_point * order.factor_work() : 20 + 0.005 * per_point * order.factor_work();
  solution = 0.025 * per_point * order.solution_work() * from_memory;
  step = 8 + 2 * solution;
}

}  // namespace softffd
