#include "methods/runge_kutta.hpp"

#include <cmath>

#include "model/arithmetic.hpp"

namespace softffd {

namespace {

double combined(double third, double fifth) {
  const double scale = std::sqrt(fifth * fifth + 0.01 * third * third);
  return scale > 0 ? fifth * fifth / scale : scale;
}

/// Collects weighted slopes and adds their sum to a base.
class Terms {
 public:
  void add(double weight, const Points& slope) { weight_[count_] = weight, slope_[count_++] = slope.data(); }
  /// Skips slopes with a weight of zero.
  void add(double scale, const double* w, const std::vector<Points>& slopes, int count) {
    for (int j = 0; j < count; ++j)
      if (w[j] != 0) add(scale * w[j], slopes[j]);
  }
  void on(const Points& base, Points& out) const {
    kernels::combine(out.size(), base.data(), count_, weight_.data(), slope_.data(), out.data());
  }

 private:
  std::array<double, Tableau::most_stages + 1> weight_;
  std::array<const double*, Tableau::most_stages + 1> slope_;
  int count_ = 0;
};

}  // namespace

RungeKutta::RungeKutta(Method name, const Tableau& tableau, int points, int pins)
    : OneStep(name, points, pins, tableau.controller_exponent),
      tableau_(tableau),
      v_(tableau.nystroem ? 0 : tableau.stages, Points::Zero(points, 3)),
      a_(tableau.stages, Points::Zero(points, 3)),
      stage_x_(points, 3),
      inner_(points, 3),
      outside_(points, 3),
      zero_(Points::Zero(points, 3)) {}

double RungeKutta::attempt(const Equations& equations, double t, double h, const State& state) {
  const Step step{equations, t, h, state};
  if (!tableau_.nystroem) v_[0] = state.v;
  const Points& inner = equations.inner(state.x, state.v, state.spring, inner_);
  equations.acceleration(t, state.v, inner, outside_, a_[0]);
  record(step, 0, t, state.x, inner);
  for (int i = 1; i < tableau_.stages; ++i) evaluate(step, i);
  add_to_positions(step, state.x, h, tableau_.b.positions, tableau_.stages, x);
  add_to_velocities(step, state.v, tableau_.b.velocities, tableau_.stages, v);
  equations.place_pins(t + h, x, v);
  if (ledger.recording()) ledger.ends(equations, t, state.x, state.v, t + h, x, v);
  const double error = size(step, tableau_.error);
  return tableau_.safer_error ? combined(size(step, {tableau_.safer_error, tableau_.safer_error}), error) : error;
}

void RungeKutta::evaluate(const Step& step, int stage) {
  const auto& [equations, t, h, from] = step;
  const double at = t + tableau_.c[stage] * h;
  add_to_positions(step, from.x, tableau_.c[stage] * h, tableau_.row(stage), stage, stage_x_);
  if (tableau_.nystroem) {
    equations.place_pins(at, stage_x_);
    equations.acceleration(at, stage_x_, from.v, outside_, inner_, a_[stage]);
  } else {
    add_to_velocities(step, from.v, tableau_.row(stage), stage, v_[stage]);
    equations.place_pins(at, stage_x_, v_[stage]);
    equations.acceleration(at, stage_x_, v_[stage], outside_, inner_, a_[stage]);
  }
  record(step, stage, at, stage_x_, inner_);
}

void RungeKutta::record(const Step& step, int stage, double at, const Points& position, const Points& inner) {
  const double weight = tableau_.b.velocities[stage];
  if (!ledger.recording() || weight == 0) return;
  ledger.stage(step.equations, step.h * weight, at, position, inner);
  if (!tableau_.nystroem) ledger.damp(step.equations, step.h * weight, position, v_[stage]);
}

/// out = base + the displacement by the first `count` stages with the weights w. ahead: time for which the velocity at the start acts, in
/// Nystroem methods [s].
void RungeKutta::add_to_positions(const Step& step, const Points& base, double ahead, const double* w, int count, Points& out) const {
  Terms terms;
  if (!tableau_.nystroem) {
    terms.add(step.h, w, v_, count);
  } else {
    if (ahead != 0) terms.add(ahead, step.from.v);
    terms.add(step.h * step.h, w, a_, count);
  }
  terms.on(base, out);
}

void RungeKutta::add_to_velocities(const Step& step, const Points& base, const double* w, int count, Points& out) const {
  Terms terms;
  terms.add(step.h, w, a_, count);
  terms.on(base, out);
}

double RungeKutta::size(const Step& step, const Tableau::Weights& error) {
  add_to_positions(step, zero_, 0, error.positions, tableau_.stages, error_);
  const double position = position_size(error_);
  add_to_velocities(step, zero_, error.velocities, tableau_.stages, error_);
  return worse(position, velocity_size(error_));
}

}  // namespace softffd
