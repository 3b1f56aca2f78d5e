/// Backward Euler with exact contact (contact/implicit_contact.hpp) as a method: steps that are long beside a stiff body's vibrations.
#pragma once
#include "contact/implicit_contact.hpp"
#include "methods/integrator.hpp"
#include "methods/traits.hpp"

namespace softffd {

class BackwardEuler final : public Integrator {
 public:
  BackwardEuler(const Lattice& lattice, int planes) : lattice_(lattice), planes_(planes), implicit_(lattice) {}
  /// not_finite: a step found no solution, or not within the span's work.
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) override;
  /// Number of factors made so far.
  Count factorizations() const { return contact_ ? contact_->factorizations() : 0; }

 private:
  Lattice lattice_;
  int planes_;
  std::unique_ptr<ImplicitContact> contact_;  ///< made when the body is known
  ImplicitWork implicit_;
  Count version_ = -1;  ///< of the body
};

}  // namespace softffd
