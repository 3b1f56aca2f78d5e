#include "model/rotation.hpp"

#include "check.hpp"

using namespace softffd;

TEST(sine_and_cosine_agree_with_the_library) {
  for (double angle = -40; angle < 40; angle += 0.0137) {
    const SineCosine r = sine_cosine(angle);
    CHECK_NEAR(r.sine, std::sin(angle), 4e-15);  // the argument's own rounding grows with it
    CHECK_NEAR(r.cosine, std::cos(angle), 4e-15);
  }
  CHECK(sine_cosine(0).sine == 0 && sine_cosine(0).cosine == 1);
}

TEST(a_quarter_turn_about_z_takes_x_to_y_and_rotation_keeps_lengths) {
  const Vec3 turned = rotated(Vec3(0, 0, std::acos(0.0)), Vec3(1, 0, 0));
  CHECK_NEAR((turned - Vec3(0, 1, 0)).norm(), 0.0, 1e-15);
  const double half = std::sqrt(0.5);
  CHECK_NEAR((rotated(std::array<double, 4>{half, 0, 0, half}, Vec3(1, 0, 0)) - Vec3(0, 1, 0)).norm(), 0.0, 1e-15);
  const Vec3 w(0.3, -1.2, 2.0), v(4, 5, -6);
  CHECK_NEAR(rotated(w, v).norm(), v.norm(), 1e-14);
  CHECK_NEAR((rotated(-w, rotated(w, v)) - v).norm(), 0.0, 1e-14);
}

TEST(what_follows_a_rotation_vector_turns_with_its_spin) {
  const Vec3 rate(0.4, -0.7, 1.1), v(4, 5, -6);
  for (const double angle : {0.0, 1e-9, 0.1, 2.0, 3.2, 7.0}) {
    const Vec3 w = angle * Vec3(0.6, 0, 0.8);
    const double d = 1e-5;
    const Vec3 measured = (rotated(w + d * rate, v) - rotated(w - d * rate, v)) / (2 * d);
    CHECK_NEAR((measured - spin_of(w, rate).cross(rotated(w, v))).norm(), 0.0, 1e-8);  // d^2 and rounding over d
    CHECK(spin_of(w, rate).norm() <= rate.norm() * (1 + 1e-15));
  }
}
