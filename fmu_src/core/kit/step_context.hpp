/// The current communication step: what is asked for, and the model, drive and run that take part.
#pragma once
#include <cmath>

#include "body/equations.hpp"
#include "body/model.hpp"
#include "model/drive.hpp"
#include "model/run.hpp"

namespace softffd {

struct Request {
  Method method = Method::automatic;
  double tolerance = 1e-4;  ///< error aimed at, at the end of the run [m]
  double step = 0;          ///< internal step [s]; 0: by stability and tolerance
  double horizon = 1;       ///< length of the run [s], over which errors add up
  double stirs = 0;         ///< size of the vibrations that changes from outside may set off in this step [m]
  double step_factor = 1;   ///< factor of the internal step that would be taken otherwise
};

struct StepContext {
  const Model& model;
  const Drive& drive;
  const Request& request;
  Run& run;

  Equations equations() const { return {model.body, drive}; }
};

/// Status of a forecast of work that is refused; not_finite if the work is NaN because the state has gone astray.
inline StepStatus refusal(double work) { return std::isnan(work) ? StepStatus::not_finite : StepStatus::too_much_work; }

}  // namespace softffd
