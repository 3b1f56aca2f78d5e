#include "watch/vibration.hpp"

#include <limits>

#include "body/stability.hpp"
#include "method_runs.hpp"

using namespace softffd;

namespace {

Scalars time_scales(const Body& body) {
  Stability stability(body.points());
  stability.prepare(body);
  Scalars scales(3 * body.points());
  stability.time_scales(body, scales);
  return scales;
}

double all_vibration(const Scene& s) { return vibration({s.body, s.around}, s.start, time_scales(s.body)); }

/// Of what is faster than so many seconds: everything.
double now_present(const Scene& s, double slow = 1e9) { return present_vibration({s.body, s.around}, s.start, time_scales(s.body), slow); }

}  // namespace

TEST(a_held_extension_counts_twice_and_is_not_present) {
  const Oscillator o{.f = 50 * 0.1, .y0 = 0.1, .w0 = 0};  // f = k y0
  const Scene s = scene(o, 1);
  CHECK_NEAR(all_vibration(s), 2 * o.y0, 1e-14);
  CHECK_NEAR(now_present(s), 0.0, 1e-14);
}

TEST(a_known_mode_is_bounded_in_every_phase) {
  const Oscillator o{.y0 = 1e-3, .w0 = 0};
  double least = 1e300, most = 0;
  for (int i = 0; i < 64; ++i) {
    const auto [y, w] = o.at(i * 2 * 3.14159265358979 / 64 / o.omega());
    const Scene s = scene({.y0 = y, .w0 = w}, 1);
    for (const double size : {all_vibration(s), now_present(s)}) {
      least = std::min(least, size / o.y0);
      most = std::max(most, size / o.y0);
    }
  }
  CHECK(least >= 2);  // a bound of what an error in its phase can amount to: from one side to the other
  CHECK(most <= 50);  // ... that is good for something
}

TEST(slow_points_and_the_bodys_motion_as_a_whole_are_left_out) {
  Scene s = scene({.y0 = 0, .w0 = 0}, 1);
  s.start.v.col(1).setConstant(3);
  s.around.force.col(2).setConstant(-9.81 * 0.25);
  CHECK_NEAR(now_present(s), 0.0, 1e-13);
  CHECK(now_present(scene({}, 1), time_scales(s.body).minCoeff()) == 0);
}

TEST(time_scales_are_proportional_to_the_unit_of_time) {
  const Scalars scales = time_scales(scene({.k = 1000}, 1).body), slow = time_scales(scene({.k = 1000 * 0x1p-80}, 1).body);
  CHECK(scales.maxCoeff() < 1);
  CHECK((slow == 0x1p40 * scales).all());
}

TEST(a_jump_of_the_forces_sets_off_its_mode) {
  const Oscillator o{.y0 = 0, .w0 = 0};
  const Scene s = scene(o, 1);
  Points jump = scene({.f = 2}, 1).around.force, scratch(8, 3);
  jump.col(1) += 7;  // moves the body as a whole
  const Vibration found = set_off({s.body, s.around}, s.start, s.start, 1, jump, scratch);
  CHECK_NEAR(found.frequency, o.omega(), 1e-12 * o.omega());
  CHECK_NEAR(found.amplitude, 2 / (o.m * o.omega() * o.omega()), 1e-14);
}

TEST(a_blow_sets_off_its_mode_by_what_came_at_once) {
  const Oscillator o{.y0 = 0, .w0 = 0};
  const Scene s = scene(o, 1);
  State end = scene({.y0 = 0, .w0 = 0.6}, 1).start;
  end.v.col(2).array() += 4;
  for (const double kink : {1.0, 0.25}) {
    Points none = Points::Zero(8, 3), scratch(8, 3);
    const Vibration found = set_off({s.body, s.around}, s.start, end, kink, none, scratch);
    CHECK_NEAR(found.frequency, o.omega(), 1e-12 * o.omega());
    CHECK_NEAR(found.amplitude, kink * 0.5 * 0.6 / o.omega(), 1e-14);
  }
}

TEST(a_motion_that_is_no_number_is_larger_than_any) {
  for (Points State::* part : {&State::x, &State::v, &State::spring}) {
    Scene s = scene({}, 1);
    (s.start.*part)(0) = std::numeric_limits<double>::quiet_NaN();
    CHECK(all_vibration(s) == INFINITY && now_present(s) == INFINITY);
  }
}
