/// Implicit steps with exact contact (contact/implicit/implicit_contact.hpp) as methods: steps that are long beside a stiff body's
/// vibrations, of first order and of second.
#pragma once
#include "contact/implicit/implicit_contact.hpp"
#include "methods/integrator.hpp"
#include "methods/traits.hpp"

namespace softffd {

class BackwardEuler final : public Integrator {
 public:
  /// samples: of the surface, where planes meet it.
  BackwardEuler(const Lattice& lattice, int planes, int pins, const Samples* samples)
      : contact_(lattice, planes, pins, samples), implicit_(lattice) {}
  /// not_finite: a step found no solution, or not within the span's work.
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

/// By the same matrices.
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
