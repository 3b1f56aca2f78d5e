#include "model/arithmetic.hpp"

#include <limits>

#include "check.hpp"

using namespace softffd;

TEST(what_is_no_number_is_the_worse_error_and_the_tighter_limit) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(worse(1, 2) == 2 && worse(2, 1) == 2 && tighter(1, 2) == 1 && tighter(2, 1) == 1);
  CHECK(std::isnan(worse(nan, 1)) && std::isnan(worse(1, nan)));
  CHECK(std::isnan(tighter(nan, 1)) && std::isnan(tighter(1, nan)));
}
