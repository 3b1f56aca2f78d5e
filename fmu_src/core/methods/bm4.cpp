#include "methods/bm4.hpp"

#include <array>
#include <cmath>

#include "methods/traits.hpp"

namespace softffd {

namespace {

// Blanes, Moan 2002, Practical symplectic partitioned Runge-Kutta and Runge-Kutta-Nystrom methods, J. Comput. Appl. Math. 142.
constexpr double b1 = 0.0829844064174052, b2 = 0.396309801498368, b3 = -0.0390563049223486;
constexpr double a1 = 0.245298957184271, a2 = 0.604872665711080;
constexpr std::array<double, 4> kick_weights{b1, b2, b3, 1 - 2 * (b1 + b2 + b3)};
constexpr std::array<double, 6> drift_weights{a1, a2, 0.5 - (a1 + a2), 0.5 - (a1 + a2), a2, a1};
constexpr std::array<int, 7> order{0, 1, 2, 3, 2, 1, 0};

struct Decay {
  double e, mean;  ///< exp(-z) and (1 - exp(-z)) / z
};

/// Above `vanished`, exp(-z) counts as zero. Up to `near_zero`, the series of (1 - exp(-z)) / z may end with the given term: its error is
/// below rounding.
constexpr double vanished = 1000, near_zero = 0.25;
constexpr int last_term = 13;

/// Uses a series near zero and doubling, because the exponential of the C library differs in the last bit between processors.
Decay decay(double z) {
  if (z > vanished) return {0, 1 / z};
  int doublings = 0;
  while (std::abs(z) > near_zero) z *= 0.5, ++doublings;
  double mean = 1;
  for (int n = last_term; n > 1; --n) mean = 1 - z / n * mean;
  double e = 1 - z * mean;
  for (; doublings > 0; --doublings) mean *= 0.5 * (1 + e), e *= e;
  return {e, mean};
}

}  // namespace

Bm4::Bm4(int points, int pins)
    : kicks_(kick_weights.size(), KickCoefficients(points)),
      half_kicks_(kicks_),
      outside_(points, 3),
      next_(points, 3),
      middle_(points, 3),
      start_x_(points, 3),
      start_v_(points, 3),
      ledger_(pins) {}

void Bm4::prepare(const Body& body, double h) {
  if (h == h_ && body.version == version_) return;
  h_ = h;
  version_ = body.version;
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < body.inverse_mass.size(); ++i) {
      const double tau = kick_weights[k] * h;
      const Decay whole = decay(tau * body.damping_rate[i]), half = decay(0.5 * tau * body.damping_rate[i]);
      kicks_[k].a[i] = whole.e;
      kicks_[k].b[i] = tau * body.inverse_mass[i] * whole.mean;
      half_kicks_[k].a[i] = half.e;
      half_kicks_[k].b[i] = 0.5 * tau * body.inverse_mass[i] * half.mean;
    }
    kicks_[k].find_even();
  }
}

void Bm4::kick(const Equations& equations, int k, double t, State& state) {
  const Points& force = equations.outside(t, outside_);
  const auto apply = [&](const KickCoefficients& c, Points& v) { c.apply(state.spring, force, v); };
  if (!ledger_.recording()) return apply(kicks_[k], state.v);
  equations.place_pins(t, state.x, state.v);  // damping also takes energy from the present motion of pinned points
  const double tau = kick_weights[k] * h_;
  ledger_.stage(equations, tau, t, state.x, state.spring);
  ledger_.damp(equations, tau / 6, state.x, state.v);
  middle_ = state.v;
  apply(half_kicks_[k], middle_);
  ledger_.damp(equations, 4 * tau / 6, state.x, middle_);
  apply(kicks_[k], state.v);
  ledger_.damp(equations, tau / 6, state.x, state.v);
}

Outcome Bm4::advance(const Model& model, const Drive& drive, const Span& span, Run& run) {
  const Equations equations{model.body, drive};
  prepare(model.body, span.h);
  ledger_.open(equations, drive.watch);
  if (!ledger_.recording() && !drive.ramped && model.body.fused())
    glide(equations, span, run.physical.motion);
  else
    for (Count i = 0; i < span.steps; ++i) step(equations, span.time(i), span.h, run.physical.motion, run.physical.exchange);
  return {.work = double(span.steps) * traits(Method::bm4).work};
}

/// Takes steps for which nothing is needed between forces and drift: each pair of a kick and a drift is one fused pass.
void Bm4::glide(const Equations& equations, const Span& span, State& state) {
  const auto& [body, around] = equations;
  kicks_[order[0]].apply(state.spring, around.force, state.v);
  kernels::drift(state.x.size(), drift_weights[0] * h_, state.x.data(), state.v.data(), next_.data());
  state.x.swap(next_);
  const Count drifts = Count(drift_weights.size()), last = span.steps * drifts;
  for (Count n = 1; n < last; ++n) {
    const int i = int(n % drifts);
    const Stage::Kick kick = kicks_[order[i]].kick();
    body.fused()->advance({{kick, kick}, i == 0 ? 2 : 1, drift_weights[i] * h_, around.even}, around.force, state.x, state.v, next_);
    state.x.swap(next_);
  }
  body.internal_force(state.x, state.spring);
  kicks_[order[0]].apply(state.spring, around.force, state.v);
}

void Bm4::step(const Equations& equations, double t, double h, State& state, Exchange& exchange) {
  ledger_.open(equations, equations.around.watch);
  const bool recording = ledger_.recording(), pins = !equations.around.pins.empty();
  if (recording) start_x_ = state.x, start_v_ = state.v;
  double weight = 0;
  kick(equations, order[0], t, state);
  for (int i = 0; i < 6; ++i) {
    weight += drift_weights[i];
    const double at = i == 5 ? t + h : t + weight * h;
    kernels::drift(state.x.size(), drift_weights[i] * h, state.x.data(), state.v.data(), next_.data());
    state.x.swap(next_);
    if (pins) equations.place_pins(at, state.x);
    equations.body.internal_force(state.x, state.spring);
    kick(equations, order[i + 1], at, state);
  }
  if (pins) equations.place_pins(t + h, state.x, state.v);
  if (!recording) return;
  ledger_.ends(equations, t, start_x_, start_v_, t + h, state.x, state.v);
  ledger_.add_to(exchange);
}

}  // namespace softffd
