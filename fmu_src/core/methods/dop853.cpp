#include "methods/dop853.hpp"

#include <array>
#include <cmath>

namespace softffd {

namespace {

// Hairer, Norsett, Wanner 1993, Solving Ordinary Differential Equations I, section II.10: DOP853, order 8(5,3), 12 stages.
constexpr int stages = 12;
constexpr std::array<double, 12> c{0,
                                   0.05260015195876773,
                                   0.0789002279381516,
                                   0.1183503419072274,
                                   0.2816496580927726,
                                   0.3333333333333333,
                                   0.25,
                                   0.3076923076923077,
                                   0.6512820512820513,
                                   0.6,
                                   0.8571428571428571,
                                   1.0};
// row i begins at i (i - 1) / 2
constexpr std::array<double, 66> a{0.05260015195876773,
                                   0.0197250569845379,
                                   0.0591751709536137,
                                   0.02958758547680685,
                                   0,
                                   0.08876275643042054,
                                   0.2413651341592667,
                                   0,
                                   -0.8845494793282861,
                                   0.924834003261792,
                                   0.037037037037037035,
                                   0,
                                   0,
                                   0.17082860872947386,
                                   0.12546768756682242,
                                   0.037109375,
                                   0,
                                   0,
                                   0.17025221101954405,
                                   0.06021653898045596,
                                   -0.017578125,
                                   0.03709200011850479,
                                   0,
                                   0,
                                   0.17038392571223998,
                                   0.10726203044637328,
                                   -0.015319437748624402,
                                   0.008273789163814023,
                                   0.6241109587160757,
                                   0,
                                   0,
                                   -3.3608926294469414,
                                   -0.868219346841726,
                                   27.59209969944671,
                                   20.154067550477894,
                                   -43.48988418106996,
                                   0.47766253643826434,
                                   0,
                                   0,
                                   -2.4881146199716677,
                                   -0.590290826836843,
                                   21.230051448181193,
                                   15.279233632882423,
                                   -33.28821096898486,
                                   -0.020331201708508627,
                                   -0.9371424300859873,
                                   0,
                                   0,
                                   5.186372428844064,
                                   1.0914373489967295,
                                   -8.149787010746927,
                                   -18.52006565999696,
                                   22.739487099350505,
                                   2.4936055526796523,
                                   -3.0467644718982196,
                                   2.273310147516538,
                                   0,
                                   0,
                                   -10.53449546673725,
                                   -2.0008720582248625,
                                   -17.9589318631188,
                                   27.94888452941996,
                                   -2.8589982771350235,
                                   -8.87285693353063,
                                   12.360567175794303,
                                   0.6433927460157636};
constexpr std::array<double, 12> b{0.054293734116568765,
                                   0,
                                   0,
                                   0,
                                   0,
                                   4.450312892752409,
                                   1.8915178993145003,
                                   -5.801203960010585,
                                   0.3111643669578199,
                                   -0.1521609496625161,
                                   0.20136540080403034,
                                   0.04471061572777259};
constexpr std::array<double, 12> e3{-0.18980075407240762,
                                    0,
                                    0,
                                    0,
                                    0,
                                    4.450312892752409,
                                    1.8915178993145003,
                                    -5.801203960010585,
                                    -0.4226823213237919,
                                    -0.1521609496625161,
                                    0.20136540080403034,
                                    0.02265179219836082};
constexpr std::array<double, 12> e5{0.01312004499419488,
                                    0,
                                    0,
                                    0,
                                    0,
                                    -1.2251564463762044,
                                    -0.4957589496572502,
                                    1.6643771824549864,
                                    -0.35032884874997366,
                                    0.3341791187130175,
                                    0.08192320648511571,
                                    -0.022355307863886294};

/// Hairer's combination of the two embedded errors: order 7 where both are small, and safe where the fifth-order one fails.
double combined(double third, double fifth) {
  const double scale = std::sqrt(fifth * fifth + 0.01 * third * third);
  return scale > 0 ? fifth * fifth / scale : scale;
}

}  // namespace

Dop853::Dop853(int points, int pins)
    : OneStep(Method::dop853, points, pins, 8), stage_x_(points, 3), spring_(points, 3), outside_(points, 3), zero_(points, 3) {
  zero_.setZero();
  for (auto* list : {&v_, &a_})
    for (Points& k : *list) k.setZero(points, 3);
}

double Dop853::attempt(const Equations& equations, double t, double h, const State& state) {
  const std::size_t n = x.size();
  const bool recording = ledger.recording();
  std::array<double, stages> weight;
  std::array<const double*, stages> term;
  const auto combine = [&](const Points& base, const Slopes& slopes, const double* w, int count, Points& out) {
    int used = 0;
    for (int j = 0; j < count; ++j)
      if (w[j] != 0) weight[used] = h * w[j], term[used++] = slopes[j].data();
    kernels::combine(n, base.data(), used, weight.data(), term.data(), out.data());
  };
  const auto size = [&](const double* w) {
    combine(zero_, v_, w, stages, error_);
    const double position = position_size(error_);
    combine(zero_, a_, w, stages, error_);
    return std::max(position, velocity_size(error_));
  };
  v_[0] = state.v;
  equations.acceleration(t, state.v, state.spring, outside_, a_[0]);
  const auto record = [&](int i, double at, const Points& position, const Points& spring) {
    if (!recording || b[i] == 0) return;
    ledger.stage(equations, h * b[i], at, position, spring);
    ledger.damp(equations, h * b[i], v_[i]);
  };
  record(0, t, state.x, state.spring);
  for (int i = 1; i < stages; ++i) {
    const double at = t + c[i] * h;
    combine(state.x, v_, &a[i * (i - 1) / 2], i, stage_x_);
    combine(state.v, a_, &a[i * (i - 1) / 2], i, v_[i]);
    equations.place_pins(at, stage_x_, v_[i]);
    equations.acceleration(at, stage_x_, v_[i], outside_, spring_, a_[i]);
    record(i, at, stage_x_, spring_);
  }
  combine(state.x, v_, b.data(), stages, x);
  combine(state.v, a_, b.data(), stages, v);
  equations.place_pins(t + h, x, v);
  if (recording) ledger.ends(equations, t, state.x, state.v, t + h, x, v);
  return combined(size(e3.data()), size(e5.data()));
}

}  // namespace softffd
