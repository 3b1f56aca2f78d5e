/// A lattice of 3 x 3 x 3 that vibrates, with all that internal steps need.
#pragma once
#include "bodies.hpp"
#include "kit/integrators.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

struct Bench {
  Lattice lattice{{3, 3, 3}};
  Model model{even_body(lattice, 100)};
  Drive drive = no_forces(lattice.points());
  Request request{.tolerance = 1e-6};
  Run run;
  Integrators integrators;

  /// planes: that the lattice does not come to.
  explicit Bench(int planes = 0) : integrators(lattice, planes, 0) {
    const int n = lattice.points();
    model.renew();
    drive.planes.resize(planes);
    for (Plane& plane : drive.planes) plane.point = {0, 0, -10};
    run.physical.exchange.planes.resize(planes);
    State& motion = run.physical.motion = at_rest(lattice);
    motion.x.col(0) *= 1.1;
    for (MarkedPoints* points : {&motion.previous, &run.control.bound_x, &run.control.factored.x}) points->change().setZero(n, 3);
    model.body.internal_force(motion.x, motion.spring);
  }
  StepContext context() { return {model, drive, request, run}; }
};

}  // namespace softffd
