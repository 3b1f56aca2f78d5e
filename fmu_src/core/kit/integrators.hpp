/// All methods of a lattice, by name; and internal steps of any of them, which stop where one goes behind an obstacle that its method does
/// not know.
#pragma once
#include <array>
#include <memory>

#include "contact/reach.hpp"
#include "kit/budget.hpp"
#include "kit/job.hpp"
#include "methods/one_step.hpp"
#include "methods/traits.hpp"

namespace softffd {

class BackwardEuler;
class Ros34pw2;

class Integrators {
 public:
  /// samples: of the surface, where planes meet it.
  Integrators(const Lattice& lattice, int planes, int pins, const Samples* samples = nullptr);
  Integrators(Integrators&&) noexcept;
  ~Integrators();

  Integrator& operator[](Method method) { return *all_[std::size_t(method)]; }
  /// Of those with error control.
  OneStep& one_step(Method method) { return static_cast<OneStep&>((*this)[method]); }
  const ImplicitWork& implicit_work() const { return implicit_work_; }
  /// Number of matrices factored since the start: none unless implicit steps are tried.
  Count factorizations() const;

  /// Internal steps of the run. contact_ahead: one went behind an obstacle. not_finite: a number is not, or the body is so far away that
  /// rounding is larger than it. too_much_work: nothing is left of the budget.
  Outcome take(const Job& job, Method method, const Span& span);
  /// Does a step of length h from (t, x0, v0) to (x, v) go behind an obstacle? In the body's frame the end decides, as it does for the
  /// implicit contact step, which would take over.
  bool passes(const Job& job, Method method, double t, double h, const Points& x0, const Points& v0, const Points& x, const Points& v);
  Reach& reach() { return reach_; }
  /// Of the call; what is not taken by `take` is booked by who takes it.
  Budget& budget() { return budget_; }

 private:
  Outcome take_span(const Job& job, Method method, const Span& span);

  std::array<std::unique_ptr<Integrator>, method_count> all_;
  const Ros34pw2* ros34pw2_ = nullptr;
  const BackwardEuler* backward_euler_ = nullptr;
  ImplicitWork implicit_work_;
  Reach reach_;
  Budget budget_;
  Points x0_, v0_;
};

}  // namespace softffd
