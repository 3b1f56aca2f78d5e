/// Limits and forecasts: of a state that is not a number none may pass for a good one.
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
      State spoilt = b.run.physical.motion;
      (spoilt.*part)(i) = no_number;
      CHECK(growing(b.context(), b.run.physical.motion, spoilt, 1) == INFINITY);
      CHECK(growing(b.context(), spoilt, b.run.physical.motion, 1) == INFINITY);
      CHECK(scattered(b.context(), b.run.physical.motion, spoilt, 1) == INFINITY);
    }
}

TEST(what_scatters_counts_where_it_has_moved_something_and_spreads_over_the_body) {
  Bench b;
  b.request.horizon = 1;
  const State& motion = b.run.physical.motion;
  const double stretch = 1e-4, places = std::sqrt(b.model.body.points() * 3.0);
  State struck = motion;
  struck.v(13, 1) += 1;
  CHECK(scattered(b.context(), motion, struck, stretch) == 0);  // it came down within the last step
  struck = motion;
  struck.x(13, 1) += 1e-3;
  const double once = 1e-3, all = scattered(b.context(), motion, struck, stretch);
  CHECK_NEAR(all, once * std::sqrt(1 / stretch) * 3.5 / places, 1e-12);
  CHECK_NEAR(scattered(b.context(), motion, struck, 1), once, 1e-15);  // one stretch: it is where it has arisen
}

TEST(a_body_that_is_nowhere_has_deformed_since_its_bound_and_no_step_is_short_enough_for_its_spin) {
  Bench b, other;
  CHECK(bound(b.context()) > 0 && !deformed_since_bound(b.context()));
  b.run.physical.motion.x(13, 1) = other.run.physical.motion.v(13, 1) = no_number;
  CHECK(deformed_since_bound(b.context()));
  for (Method method : {Method::ros34pw2, Method::floating_frame}) CHECK(!(step_limit(other.context(), method, false) > 0));
}
