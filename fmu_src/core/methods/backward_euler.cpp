#include "methods/backward_euler.hpp"

#include <algorithm>

namespace softffd {

Outcome BackwardEuler::advance(const Model& model, const Drive& drive, const Span& span, Run& run) {
  if (version_ != model.body.version) contact_.body_changed();
  version_ = model.body.version;
  Outcome outcome;
  const double most = std::min(span.most_work, 0x1p53);
  contact_.most_factorizations = Count(std::max(1.0, most / implicit_.factor));
  for (Count i = 0; i < span.steps && outcome.status == StepStatus::ok; ++i) {
    const Count made = contact_.factorizations();
    outcome.status = contact_.advance({model.body, drive}, span.time(i), span.h, drive.watch, run.path.motion, run.path.exchange);
    outcome.given += contact_.given();
    outcome.work += std::max(traits(Method::backward_euler).work, double(contact_.factorizations() - made) * implicit_.factor);
  }
  return outcome;
}

}  // namespace softffd
