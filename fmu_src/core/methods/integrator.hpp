/// The interface of all methods. A new method is a file here, a row in traits.cpp, an entry in kit/integrators.cpp and in the test list.
#pragma once
#include "body/equations.hpp"
#include "body/model.hpp"
#include "contact/slip.hpp"
#include "model/run.hpp"

namespace softffd {

struct Outcome {
  StepStatus status = StepStatus::ok;
  double error = 0;       ///< largest estimated error of a step [m]; 0 without error control
  double work = 0;        ///< by which methods are compared, in evaluations of the spring forces
  double spent = 0;       ///< work taken from the budget, if more than `work`
  Count impacts = 0;      ///< number of points that landed on an obstacle
  double given = 0;       ///< energy from obstacles and pins, minus what friction and free bodies lost [J]; implicit contact only
  Slip slip{};            ///< of the contacts in the last step; implicit contact only
  Count constraints = 0;  ///< identifies the contacts at the end and which of them slide; implicit contact only
  double lost = 0;        ///< energy that the steps took beyond damping and friction [J]; sdirk2 only
  double bend = 0;        ///< largest bend of the velocities within a step, as a displacement [m]; sdirk2 only
};

class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Integrates the motion over the span and adds the reactions to the run's exchange. The caller sets `run.physical.motion.time`, clock
  /// and counts, and books the work. If the status is not ok, motion and exchange are invalid, and a Snapshot has to restore them.
  virtual Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) = 0;
  /// Number of matrices factored so far.
  virtual Count factorizations() const { return 0; }
};

}  // namespace softffd
