#include "model/marked_points.hpp"

#include "check.hpp"

using namespace softffd;

namespace {

MarkedPoints points(double value, int count = 5) {
  MarkedPoints made;
  made.change().setConstant(count, 3, value);
  return made;
}

bool all_are(const MarkedPoints& points, double value) { return points->size() > 0 && (*points == value).all(); }

}  // namespace

TEST(a_copy_has_the_numbers_of_its_last_change) {
  MarkedPoints x = points(1), kept = points(2);
  kept = x;
  CHECK(all_are(kept, 1) && kept.mark() == x.mark());
  x.change().setConstant(3);
  CHECK(kept.mark() != x.mark() && all_are(kept, 1));
  kept = x;
  CHECK(all_are(kept, 3));
  x = points(4, 7);
  kept = x;
  CHECK(all_are(kept, 4) && kept->rows() == 7);
}

TEST(equal_numbers_are_copied_where_they_were_made_apart_and_what_is_moved_takes_its_mark_along) {
  MarkedPoints x = points(1);
  const MarkedPoints copy = points(1);
  CHECK(x.mark() != copy.mark());
  const double* place = x->data();
  x = copy;
  CHECK(x.mark() == copy.mark() && x->data() == place);
  MarkedPoints taken = std::move(x);
  CHECK(all_are(taken, 1));
  x = copy;
  CHECK(all_are(x, 1));
  MarkedPoints other = points(2);
  const MarkedPoints twos = other;
  other = std::move(taken);
  taken = twos;
  CHECK(all_are(other, 1) && all_are(taken, 2));
  taken = copy;
  CHECK(all_are(taken, 1));
}

TEST(points_that_somebody_else_marked_are_copied_once) {
  Points numbers = Points::Constant(4, 3, 1);
  const Count mark = MarkedPoints::new_mark();
  MarkedPoints x;
  x.copy(numbers, mark);
  CHECK(all_are(x, 1));
  numbers.setConstant(2);
  x.copy(numbers, mark);
  CHECK(all_are(x, 1));
  x.copy(numbers, MarkedPoints::new_mark());
  CHECK(all_are(x, 2));
}
