/// A lattice of 3 x 3 x 3 that vibrates, with all that internal steps need.
#pragma once
#include "kit/integrators.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

struct Bench {
  Lattice lattice{{3, 3, 3}};
  Model model{body(lattice)};
  Drive drive;
  Request request{.tolerance = 1e-6};
  Run run;
  Integrators integrators;

  /// planes: that the lattice does not come to.
  explicit Bench(int planes = 0) : integrators(lattice, planes, 0) {
    const int n = lattice.points();
    model.body.springs.set_stiffness({100, 100, 100}, {});
    model.renew();
    drive.planes.resize(planes);
    for (Plane& plane : drive.planes) plane.point = {0, 0, -10};
    run.path.exchange.planes.resize(planes);
    for (Points* points : {&drive.force, &drive.force_rate, &drive.force_bend[0], &drive.force_bend[1]}) points->setZero(n, 3);
    State& motion = run.path.motion;
    motion.x = rest_positions(lattice);
    motion.x.col(0) *= 1.1;
    for (Points* points : {&motion.v, &motion.spring}) points->setZero(n, 3);
    for (MarkedPoints* points : {&motion.previous, &run.course.bound_x, &run.course.factored.x}) points->change().setZero(n, 3);
    model.body.internal_force(motion.x, motion.spring);
  }
  static Body body(const Lattice& lattice) {
    const int n = lattice.points();
    return {.springs = Springs(lattice, Topology::distinct),
            .mass = Scalars::Constant(n, 1.0 / n),
            .damping = Scalars::Zero(n),
            .pinned = std::vector<bool>(n, false)};
  }
  Job job() { return {model, drive, request, run}; }
};

}  // namespace softffd
