/// Implicit steps with exact contact (contact/implicit/implicit_contact.hpp) as methods of first and of second order, for steps that are
/// long compared with the vibrations of a stiff body.
#pragma once
#include "contact/implicit/implicit_contact.hpp"
#include "methods/integrator.hpp"
#include "methods/traits.hpp"

namespace softffd {

class BackwardEuler final : public Integrator {
 public:
  /// samples: of the surface, which planes meet; null: planes meet the control points.
  BackwardEuler(const Lattice& lattice, int planes, int pins, const Samples* samples)
      : contact_(lattice, planes, pins, samples), implicit_(lattice) {}
  /// The status is not_finite if a step found no solution, or none within the work of the span.
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) override {
    return advance(Method::backward_euler, model, drive, span, run);
  }
  Count factorizations() const override { return contact_.factorizations(); }

 private:
  friend class Sdirk2;
  Outcome advance(Method method, const Model& model, const Drive& drive, const Span& span, Run& run);

  ImplicitContact contact_;
  ImplicitWork implicit_;
  Count version_ = -1;  ///< of the body
};

/// The method of second order, which uses the matrices of BackwardEuler.
class Sdirk2 final : public Integrator {
 public:
  explicit Sdirk2(BackwardEuler& euler) : euler_(euler) {}
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) override {
    return euler_.advance(Method::sdirk2, model, drive, span, run);
  }

 private:
  BackwardEuler& euler_;
};

}  // namespace softffd
