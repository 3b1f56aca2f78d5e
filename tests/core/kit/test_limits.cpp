/// Limits and forecasts of a state that is not a number: none of them may pass for a good one.
#include "kit/limits.hpp"

#include <limits>

#include "bench.hpp"
#include "check.hpp"

using namespace softffd;

static constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

TEST(what_differs_by_something_that_is_no_number_differs_by_more_than_anything) {
  for (Points State::* part : {&State::x, &State::v})
    for (int i : {0, 40, 80}) {
      Bench b;
      State spoilt = b.run.path.motion;
      (spoilt.*part)(i) = no_number;
      CHECK(growing(b.context(), b.run.path.motion, spoilt, 1) == INFINITY);
      CHECK(growing(b.context(), spoilt, b.run.path.motion, 1) == INFINITY);
    }
}

TEST(a_body_that_is_nowhere_has_deformed_since_its_bound_and_no_step_is_short_enough_for_its_spin) {
  Bench b, other;
  CHECK(bound(b.context()) > 0 && !deformed_since_bound(b.context()));
  b.run.path.motion.x(13, 1) = other.run.path.motion.v(13, 1) = no_number;
  CHECK(deformed_since_bound(b.context()));
  for (Method method : {Method::ros34pw2, Method::floating_frame}) CHECK(!(step_limit(other.context(), method, false) > 0));
}
