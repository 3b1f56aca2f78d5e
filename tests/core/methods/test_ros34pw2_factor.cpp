#include "ros34pw2_scenes.hpp"

using namespace softffd;

TEST(the_error_estimate_finds_a_factor_that_is_too_old) {
  const Scene s = stiff();
  const Equations equations{s.body, s.around};
  const double h = 0.02;
  Ros34pw2 method(s.lattice, 0);
  Result r = begin(s);
  for (int i = 0; i < 2; ++i) {
    method.ledger.open(equations, false);
    CHECK(method.attempt(equations, i * h, h, r.state) < 1e-4);
    accept(method, s, h, r);
  }
  // under load the body resists turning, of which the unloaded stiffness knows nothing
  CHECK(method.attempt(equations, 2 * h, h, r.state) > 1);
  method.refresh();
  CHECK(method.attempt(equations, 2 * h, h, r.state) < 1e-4);
}

TEST(a_factor_serves_twenty_steps) {
  const Scene s = soft(true);
  Ros34pw2 method(s.lattice, 0);
  CHECK(method.factorizations() == 0);
  run(method, s, 45);
  CHECK(method.factorizations() == 3);
}

TEST(a_fresh_factor_belongs_to_the_state_at_hand) {
  const Scene s = soft(true);
  const Equations equations{s.body, s.around};
  Ros34pw2 method(s.lattice, 0);
  const Result r = run(method, s, 5);
  CHECK(same_bits(*method.factored.x, s.start.x) && method.factored.uses == 5);
  method.refresh();
  method.attempt(equations, s.duration, s.duration / 5, r.state);
  CHECK(same_bits(*method.factored.x, r.state.x) && method.factored.uses == 1 && method.factorizations() == 2);
  method.attempt(equations, s.duration, s.duration / 7, r.state);
  CHECK(method.factored.h == s.duration / 7 && method.factorizations() == 3);
}

TEST(a_changed_body_gets_its_own_factor) {
  Scene s = soft();
  Ros34pw2 method(s.lattice, 0), fresh(s.lattice, 0);
  const double h = 0.01;
  const Equations equations{s.body, s.around};
  method.attempt(equations, 0, h, s.start);
  const Points before = method.x;
  springs_of(s.body).set_stiffness({300, 200, 100}, {});
  start_at(s, Points(s.start.x), Points(s.start.v));
  ++s.body.version;
  method.attempt(equations, 0, h, s.start);
  fresh.attempt(equations, 0, h, s.start);
  CHECK(same_bits(method.x, fresh.x) && !same_bits(method.x, before) && method.factorizations() == 2);
}
