/// The explicit Runge-Kutta methods: one step of any tableau (tableaus.hpp), its error and its exchange with the outside.
///
/// For x' = v, v' = a(t, x, v) a stage has two slopes, its velocity and its acceleration:
///
///      x_i = x + h sum a_ij v_j,      v_i = v + h sum a_ij a_j,      a_i = a(t + c_i h, x_i, v_i).
///
/// Nystroem methods integrate the accelerations twice instead. Their stages have no velocities, so that they are for undamped bodies only:
///
///      x_i = x + c_i h v + h^2 sum a_ij a_j,      a_i = a(t + c_i h, x_i).
///
/// The error is that of the embedded method. If there are two embedded methods, of orders 5 and 3, Hairer's combination
/// e5^2 / sqrt(e5^2 + e3^2 / 100) is of order 7 where both errors are small, and safe where the fifth-order one fails.
#pragma once
#include <vector>

#include "methods/one_step.hpp"
#include "methods/tableaus.hpp"

namespace softffd {

class RungeKutta : public OneStep {
 public:
  RungeKutta(Method name, const Tableau& tableau, int points, int pins);
  double attempt(const Equations& equations, double t, double h, const State& state) final;

 private:
  struct Step {
    const Equations& equations;
    double t, h;
    const State& from;
  };
  void evaluate(const Step& step, int stage);
  void record(const Step& step, int stage, double at, const Points& position, const Points& inner);
  void add_to_positions(const Step& step, const Points& base, double ahead, const double* w, int count, Points& out) const;
  void add_to_velocities(const Step& step, const Points& base, const double* w, int count, Points& out) const;
  double size(const Step& step, const Tableau::Weights& error);

  const Tableau& tableau_;
  std::vector<Points> v_, a_;  ///< velocities, if there are any, and accelerations at the stages
  Points stage_x_, inner_, outside_, zero_;
};

}  // namespace softffd
