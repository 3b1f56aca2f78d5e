#include "model/visit.hpp"

#include <limits>
#include <set>

#include "check.hpp"
#include "model/run.hpp"

using namespace softffd;

namespace {

struct Complete {
  double number = 1;
  Count count = 2;
  std::vector<Points> lists;
  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.number, s.count, s.lists);
  }
};

struct Forgetful {
  double number = 1;
  Count forgotten = 2;
  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.number);
  }
};

Run some_run() {
  Run run;
  run.physical.exchange.planes.resize(2);
  run.physical.exchange.pins.resize(1);
  run.contacts.resize(2);
  run.centres.resize(2);
  State& motion = run.physical.motion;
  for (Points* points : {&motion.x, &motion.v, &motion.spring}) points->setZero(5, 3);
  for (MarkedPoints* points : {&motion.previous, &run.control.bound_x, &run.control.factored.x, &run.outside})
    points->change().setZero(5, 3);
  motion.holds.assign(2, Points::Zero(5, 3));
  return run;
}

template <class Leaf>
std::size_t bytes(const Leaf& leaf) {
  if constexpr (requires { leaf.size(); })
    return sizeof(double) * leaf.size();
  else
    return sizeof leaf;
}

}  // namespace

static_assert(visits_every_field<Complete>);
static_assert(!visits_every_field<Forgetful>);
static_assert(visits_every_field<Run>);

TEST(every_byte_of_a_run_is_visited_once) {
  Run run = some_run();
  std::set<const void*> places;
  std::size_t visited = 0, leaves = 0;
  each_leaf(run, [&](const auto& leaf) {
    places.insert(&leaf);
    visited += bytes(leaf);
    ++leaves;
  });
  CHECK(places.size() == leaves);
  const std::size_t flags = 4, enumerations = 4, arrays = 7, lists = 15, holds = 2, empty = 6, marks = 5;
  const std::size_t outside = (arrays + holds) * 15 * sizeof(double) + 3 * sizeof(Impulse) + 2 * (sizeof(Count) + sizeof(Vec3));
  const std::size_t inside = sizeof(Run) - (arrays + empty) * sizeof(Points) - lists * sizeof(std::vector<Count>) - marks * sizeof(Count);
  CHECK(visited <= inside + outside && visited + flags * 7 + enumerations * 4 >= inside + outside);  // the difference: padding
}

TEST(a_number_that_is_not_finite_is_found_wherever_it_is) {
  CHECK(all_finite(some_run()));
  Run run = some_run();
  run.physical.motion.v(3, 1) = std::numeric_limits<double>::infinity();
  CHECK(!all_finite(run) && !all_finite(run.physical.motion) && all_finite(run.physical.exchange));
  run = some_run();
  run.physical.exchange.planes[1].torque[2] = std::nan("");
  CHECK(!all_finite(run.physical.exchange));
}
