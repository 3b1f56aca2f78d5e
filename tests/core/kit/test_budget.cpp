#include "kit/budget.hpp"

#include "check.hpp"

using namespace softffd;

TEST(a_budget_covers_what_is_left) {
  Budget budget;
  CHECK(budget.covers(1e300) && !budget.spent());
  budget.begin(10);
  budget.spend(8);
  CHECK(budget.covers(2) && !budget.covers(2.1) && !budget.covers(NAN) && !budget.spent());
  budget.spend(2.1);
  CHECK(budget.spent());
  budget.begin(10);
  CHECK(budget.left() == 10);
}

TEST(a_reserve_is_not_there_until_it_is_released) {
  Budget budget;
  budget.begin(10);
  {
    Budget::Reserve reserve(budget, 4), another(budget, 1);
    budget.spend(6);
    CHECK(budget.spent());
    another.release();
    reserve.release();
    CHECK(budget.left() == 4);
  }
  CHECK(budget.left() == 4);
}
