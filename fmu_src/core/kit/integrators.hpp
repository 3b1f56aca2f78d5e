/// All integration methods for one lattice, by name. Takes internal steps with any of them, and stops where a step passes behind an
/// obstacle that its method does not know.
#pragma once
#include <algorithm>
#include <array>
#include <memory>

#include "contact/broad_phase.hpp"
#include "kit/budget.hpp"
#include "kit/step_context.hpp"
#include "kit/thresholds.hpp"
#include "methods/one_step.hpp"
#include "methods/traits.hpp"
#include "watch/followed.hpp"

namespace softffd {

class Integrators {
 public:
  /// samples: the samples of the surface, if planes meet the surface; null: planes meet the control points.
  Integrators(const Lattice& lattice, int planes, int pins, const Samples* samples = nullptr);

  /// Returns the integrator of a method, which is created at the first call.
  Integrator& operator[](Method method) {
    std::unique_ptr<Integrator>& integrator = all_[std::size_t(method)];
    if (!integrator) integrator = make(method);
    return *integrator;
  }
  /// The same for a method with error control.
  OneStep& one_step(Method method) { return static_cast<OneStep&>((*this)[method]); }
  const ImplicitWork& implicit_work() const { return implicit_work_; }
  /// Work that an implicit step with contact may take at least before it is given up; less than the whole budget of the call.
  double patience() const {
    const double large =
        std::min(thresholds::patient_matrices * implicit_work_.in_contact(), thresholds::patient_fraction * budget_.left());
    return std::max(thresholds::least_implicit_work, large);
  }
  /// Number of matrices factored since the start; zero as long as no implicit steps are tried.
  Count factorizations() const;

  /// Takes internal steps of the run. Status contact_ahead: a step passed behind an obstacle. not_finite: a number is not finite, or the
  /// body is so far away that rounding is larger than the body. too_much_work: the budget is spent.
  Outcome take(const StepContext& context, Method method, const Span& span);
  /// True if a step of length h from (t, x0, v0) to (x, v) passes behind an obstacle. For a method in the body's frame only the end of the
  /// step is checked, as in the implicit contact step that would take over.
  bool passes(const StepContext& context, Method method, double t, double h, const Points& x0, const Points& v0, const Points& x,
              const Points& v);
  /// Has every internal step looked at by `points`; null: no step.
  void follow(const FollowedPoints* points) { followed_ = points; }
  BroadPhase& broad_phase() { return broad_phase_; }
  /// Budget of the call. Work that is not done by `take` is booked by the code that does it.
  Budget& budget() { return budget_; }

 private:
  std::unique_ptr<Integrator> make(Method method);
  Outcome take_followed(const StepContext& context, Method method, const Span& span);
  Outcome take_span(const StepContext& context, Method method, const Span& span);

  Lattice lattice_;
  int planes_, pins_;
  const Samples* samples_;
  std::array<std::unique_ptr<Integrator>, method_count> all_;
  ImplicitWork implicit_work_;
  BroadPhase broad_phase_;
  Budget budget_;
  Points x0_, v0_;
  const FollowedPoints* followed_ = nullptr;
};

}  // namespace softffd
