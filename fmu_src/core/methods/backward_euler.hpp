/// Backward Euler with exact contact (contact/implicit/implicit_contact.hpp) as a method: steps that are long beside a stiff body's
/// vibrations.
#pragma once
#include "contact/implicit/implicit_contact.hpp"
#include "methods/integrator.hpp"
#include "methods/traits.hpp"

namespace softffd {

class BackwardEuler final : public Integrator {
 public:
  /// samples: of the surface, where planes meet it.
  BackwardEuler(const Lattice& lattice, int planes, const Samples* samples) : contact_(lattice, planes, samples), implicit_(lattice) {}
  /// not_finite: a step found no solution, or not within the span's work.
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) override;
  /// Number of factors made so far.
  Count factorizations() const { return contact_.factorizations(); }

 private:
  ImplicitContact contact_;
  ImplicitWork implicit_;
  Count version_ = -1;  ///< of the body
};

}  // namespace softffd
