#include "body/kick.hpp"

#include "bodies.hpp"
#include "check.hpp"

using namespace softffd;

namespace {

Body one_mass(double mass, double damping) {
  Body body = even_body({{2, 2, 2}}, 0, 8 * mass);
  body.damping.setConstant(damping);
  body.damped = damping > 0;
  return body;
}

/// Velocity of point 0 after closing and opening half kicks of step h, starting from v.
double full_kick(const Body& body, double h, double v, double f) {
  HalfKicks kicks(8);
  kicks.prepare(body, h);
  Points velocity = Points::Constant(8, 3, v), force = Points::Constant(8, 3, f), none = Points::Zero(8, 3);
  Points opened = none, moved = none;
  kicks.close(force, none, velocity);
  kicks.open(force, none, velocity, none, opened, moved);
  CHECK((moved == h * opened).all());
  return opened(0, 0);
}

}  // namespace

TEST(two_halves_are_the_central_difference) {
  const double m = 0.3, d = 0.5, h = 0.1, v = 2, f = 7, g = 0.5 * d * h / m;
  CHECK_NEAR(full_kick(one_mass(m, d), h, v, f), ((1 - g) * v + h * f / m) / (1 + g), 1e-15);
  CHECK_NEAR(full_kick(one_mass(m, 0), h, v, f), v + h * f / m, 1e-15);
}

TEST(heavy_damping_ends_at_the_terminal_velocity) {
  for (double d : {1e3, 1e6, 1e9}) {
    const Body body = one_mass(1e-2, d);
    double v = 5;
    for (int i = 0; i < 60; ++i) v = full_kick(body, 1e-2, v, 7);
    CHECK_NEAR(v, 7 / d, 1e-12 * 7 / d + 1e-15);
  }
}

TEST(heavy_damping_takes_what_the_exact_decay_takes_within_three_hundredths_and_never_turns_the_velocity_round) {
  const double m = 0.3, h = 0.1, v = 1;
  for (double g : {1.001, 1.5, 2.5, 3.0, 10.0}) {  // half the step in units of the decay time
    const double left = full_kick(one_mass(m, 2 * g * m / h), h, v, 0);
    CHECK_NEAR(left, std::exp(-2 * g), 0.03);
    CHECK(left >= 0 && left < v);
  }
}
