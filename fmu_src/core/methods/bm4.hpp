/// BM4: the symplectic Runge-Kutta-Nystrom splitting SRKN6 of Blanes and Moan (2002), order 4, six force evaluations per step, symmetric.
///
/// Kicks and drifts alternate. Time advances with the drifts, so that time-dependent forces and pins keep the order. Damping is part of
/// the kicks by its exact flow, v <- E v + (1 - E) f/d with E = exp(-d b h / m).
#pragma once
#include <vector>

#include "body/kick.hpp"
#include "methods/integrator.hpp"

namespace softffd {

class Bm4 final : public Integrator {
 public:
  Bm4(int points, int pins);
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) override;

 private:
  void glide(const Equations& equations, const Span& span, State& state);
  void step(const Equations& equations, double t, double h, State& state, Exchange& exchange);
  void prepare(const Body& body, double h);
  void kick(const Equations& equations, int kick, double t, State& state);

  std::vector<KickCoefficients> kicks_, half_kicks_;  ///< half kicks give the velocity in the middle of a kick, for the dissipated energy
  double h_ = -1;
  Count version_ = -1;  ///< of the body
  Points outside_, next_, middle_, start_x_, start_v_;
  Ledger ledger_;
};

}  // namespace softffd
