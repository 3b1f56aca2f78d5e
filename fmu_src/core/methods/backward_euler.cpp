#include "methods/backward_euler.hpp"

#include <algorithm>

namespace softffd {

Outcome BackwardEuler::advance(Method method, const Model& model, const Drive& drive, const Span& span, Run& run) {
  if (version_ != model.body.version) contact_.body_changed();
  version_ = model.body.version;
  contact_.keep(run.control.in_contact);
  Outcome outcome;
  const auto most = [](double work, double each) { return Count(std::max(1.0, std::min(work, 0x1p53) / each)); };
  contact_.most_factorizations = most(std::min(span.most_work, span.budget), implicit_.factor);
  contact_.most_solutions = most(span.budget, implicit_.solution);
  const double in_evaluation = Operations::in_evaluation(model.body.points());
  contact_.most_operations = span.budget * in_evaluation;
  for (Count i = 0; i < span.steps && outcome.status == StepStatus::ok; ++i) {
    const Count made = contact_.factorizations();
    const double solved = contact_.solutions();
    PhysicalState& physical = run.physical;
    const Equations equations{model.body, drive};
    const double t = span.time(i), h = span.h;
    outcome.status = method == Method::sdirk2
                         ? contact_.advance_sdirk2(equations, t, h, span, drive.watch, physical.motion, physical.exchange)
                         : contact_.advance(equations, t, h, drive.watch, physical.motion, physical.exchange);
    outcome.given += contact_.given();
    outcome.slip = contact_.slip();
    outcome.constraints = contact_.constraints();
    outcome.lost += contact_.lost();
    outcome.bend = std::max(outcome.bend, contact_.bend());
    const double work = double(contact_.factorizations() - made) * implicit_.factor;
    outcome.work += std::max(traits(method).work, work);
    outcome.spent += work + (contact_.solutions() - solved) * implicit_.solution + contact_.operations() / in_evaluation;
  }
  return outcome;
}

}  // namespace softffd
