/// What stretches leave at the end of a run, summed.
#include "check.hpp"
#include "model/run.hpp"

using namespace softffd;

namespace {

FinalError along(const Vec3& shift) { return {.size = shift.norm(), .shift = shift}; }

}  // namespace

TEST(what_errs_now_this_way_now_that_adds_as_at_right_angles) {
  FinalError sum;
  for (int i = 0; i < 100; ++i) sum.add(along({i % 2 ? 1.0 : -1.0, 0, 0}));
  CHECK_NEAR(sum.largest(), 10, 1e-12);
}

TEST(what_errs_the_same_way_again_and_again_adds_up) {
  FinalError sum;
  for (int i = 0; i < 100; ++i) sum.add(along({1, 0, 0}));
  CHECK_NEAR(sum.largest(), 100, 1e-12);
}

TEST(vibrations_of_a_body_that_pins_hold_always_fall_behind) {
  FinalError sum;
  for (int i = 0; i < 100; ++i) sum.add({.size = 1, .lag = 1});
  CHECK_NEAR(sum.largest(), 100, 1e-12);
}

TEST(stretches_that_are_run_once_leave_as_much_as_the_last_that_was_run_twice_and_where_they_all_point) {
  FinalError known;
  for (int i = 0; i < 21; ++i) known.learn(along({1, i % 2 ? 2.0 : -2.0, 0}));
  CHECK_NEAR(known.size, std::sqrt(5.0), 1e-12);
  CHECK_NEAR(known.shift[0], 1, 1e-6);
  CHECK(std::abs(known.shift[1]) < 1);
}
