/// Soft objects as a component has them, without files.
#pragma once
#include "bodies.hpp"
#include "check.hpp"
#include "soft_body.hpp"

namespace softffd {

/// One kilogram in equal masses.
inline Definition one_kilogram(const std::array<int, 3>& counts = {4, 4, 4}, int planes = 0) {
  Definition definition;
  definition.lattice.counts = counts;
  definition.mass.assign(definition.lattice.points(), 1.0 / definition.lattice.points());
  definition.planes = planes;
  return definition;
}

/// Of springs of one stiffness [N/m].
inline SoftBody soft_body(const Definition& definition, double stiffness) {
  SoftBody body(definition);
  body.settings.stiffness = {stiffness, stiffness, stiffness};
  return body;
}

/// Communication steps of H [s], each of which has to be done.
inline void go(SoftBody& body, int steps, double H) {
  for (int i = 0; i < steps; ++i) CHECK(body.advance(H) == StepStatus::ok);
}

}  // namespace softffd
