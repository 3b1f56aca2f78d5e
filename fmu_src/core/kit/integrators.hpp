/// All methods of a lattice, by name; and internal steps of any of them, which stop where one goes behind an obstacle that its method does
/// not know.
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
  /// samples: of the surface, where planes meet it.
  Integrators(const Lattice& lattice, int planes, int pins, const Samples* samples = nullptr);

  /// Made when it is first asked for.
  Integrator& operator[](Method method) {
    std::unique_ptr<Integrator>& integrator = all_[std::size_t(method)];
    if (!integrator) integrator = make(method);
    return *integrator;
  }
  /// Of those with error control.
  OneStep& one_step(Method method) { return static_cast<OneStep&>((*this)[method]); }
  const ImplicitWork& implicit_work() const { return implicit_work_; }
  /// What an implicit step with contact may take at least before it is given up: not all that the call may.
  double patience() const {
    const double large = std::min(thresholds::patient_matrices * implicit_work_.in_contact(), thresholds::patient_share * budget_.left());
    return std::max(thresholds::least_implicit_work, large);
  }
  /// Number of matrices factored since the start: none unless implicit steps are tried.
  Count factorizations() const;

  /// Internal steps of the run. contact_ahead: one went behind an obstacle. not_finite: a number is not, or the body is so far away that
  /// rounding is larger than it. too_much_work: nothing is left of the budget.
  Outcome take(const StepContext& context, Method method, const Span& span);
  /// Does a step of length h from (t, x0, v0) to (x, v) go behind an obstacle? In the body's frame the end decides, as it does for the
  /// implicit contact step, which would take over.
  bool passes(const StepContext& context, Method method, double t, double h, const Points& x0, const Points& v0, const Points& x,
              const Points& v);
  /// Has every internal step looked at; null: none.
  void follow(const FollowedPoints* points) { followed_ = points; }
  BroadPhase& broad_phase() { return broad_phase_; }
  /// Of the call; what is not taken by `take` is booked by who takes it.
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
