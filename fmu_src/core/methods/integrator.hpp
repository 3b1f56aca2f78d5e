/// The one shape of all methods. A new one is a file here, a row in traits.cpp, its place in kit/integrators.cpp and in the test list.
#pragma once
#include "body/equations.hpp"
#include "body/model.hpp"
#include "contact/slip.hpp"
#include "model/run.hpp"

namespace softffd {

struct Outcome {
  StepStatus status = StepStatus::ok;
  double error = 0;   ///< estimated, of the largest step [m]; 0 without error control
  double work = 0;    ///< in evaluations of the spring forces, by which methods are compared
  double spent = 0;   ///< of the budget, where that is more than the work
  Count impacts = 0;  ///< points that came onto an obstacle
  double given = 0;   ///< energy that obstacles and pins gave, less what friction and free bodies lost; implicit contact alone says so [J]
  Slip slip{};        ///< of the last step's contacts; implicit contact alone says so
  Count constraints = 0;  ///< what touches at the end, and what of it slides: another number where another set; implicit contact alone
  double lost = 0;        ///< energy that the steps took beyond dampers and friction; sdirk2 alone [J]
  double bend = 0;        ///< by how much the velocities bend within the last step, as a way [m]; sdirk2 alone
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
