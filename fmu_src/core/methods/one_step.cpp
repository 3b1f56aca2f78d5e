#include "methods/one_step.hpp"

#include <limits>

#include "methods/traits.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

Outcome OneStep::offer(const Model& model, const Drive& drive, double t, double h, Run& run) {
  if (version_ != model.body.version) take_material(model);
  version_ = model.body.version;
  const Equations equations{model.body, drive};
  ledger.open(equations, drive.watch, lossy_);
  Outcome outcome = attempt_in(equations, t, h, run);
  const double size = worse(kernels::largest(x.size(), x.data()), kernels::largest(v.size(), v.data()));
  if (!std::isfinite(size)) outcome.error = std::numeric_limits<double>::infinity();  // whatever the estimate says
  return outcome;
}

Outcome OneStep::attempt_in(const Equations& equations, double t, double h, Run& run) {
  return {.error = attempt(equations, t, h, run.physical.motion), .work = traits(name_).work};
}

void OneStep::keep(const Model& model, Run& run) {
  State& motion = run.physical.motion;
  motion.x.swap(x);
  motion.v.swap(v);
  model.body.internal_force(motion.x, motion.spring);
  if (ledger.recording()) ledger.add_to(run.physical.exchange);
}

Outcome OneStep::advance(const Model& model, const Drive& drive, const Span& span, Run& run) {
  Outcome outcome;
  for (Count i = 0; i < span.steps; ++i) {
    run.control.factored.h = 0;  // the error of a given step is not checked: an old factor could spoil the step
    const Outcome step = offer(model, drive, span.time(i), span.h, run);
    keep(model, run);
    outcome.error = worse(outcome.error, step.error);
    outcome.work += step.work;
  }
  return outcome;
}

}  // namespace softffd
