#include "stepping/plan.hpp"

#include "check.hpp"
#include "kit/thresholds.hpp"
#include "methods/traits.hpp"

using namespace softffd;

namespace {

constexpr Method all[] = {Method::automatic, Method::central_difference, Method::leapfrog,       Method::bm4,    Method::rkn12,
                          Method::dop853,    Method::ros34pw2,           Method::backward_euler, Method::sdirk2, Method::floating_frame};

struct Planned {
  std::vector<Method> asked;  ///< each of them, for the same facts
  Facts facts;
  Method method;  ///< automatic: that which was asked for
  Steps steps;
  Reason reason = Reason::asked;
  Rollback rollback = Rollback::never;
  bool rings = false;
};

void require(const std::vector<Planned>& table) {
  for (std::size_t i = 0; i < table.size(); ++i)
    for (const Method asked : table[i].asked) {
      const Planned& row = table[i];
      Facts facts = row.facts;
      facts.asked = asked;
      const Plan p = plan(facts);
      const bool right = p.want == Want::nothing && p.method == (row.method == Method::automatic ? asked : row.method) &&
                         p.steps == row.steps && p.reason == row.reason && p.rollback == row.rollback && p.rings == row.rings;
      if (!right) std::printf("  row %zu, asked for method %d\n", i + 1, int(asked));
      CHECK(right);
    }
}

/// Beside an obstacle that is within reach, or not.
Facts beside(bool within_reach, double stiffness) {
  return {.obstacles = true, .clear = !within_reach, .within_reach = within_reach, .stiffness = stiffness};
}

}  // namespace

TEST(without_obstacles_everybody_gets_what_was_asked_for_unless_damping_forbids_it) {
  using enum Method;
  require({
      {{central_difference, leapfrog, bm4}, {}, automatic, Steps::fitted},
      {{rkn12, dop853, ros34pw2, floating_frame}, {}, automatic, Steps::controlled},
      {{backward_euler}, {.given_step = true}, automatic, Steps::implicit},
      {{sdirk2}, {}, automatic, Steps::damped},
      {{sdirk2}, {.given_step = true, .counted = true}, automatic, Steps::implicit},
      {{automatic, backward_euler}, {}, leapfrog, Steps::by_trials},
      {{automatic}, {.given_step = true}, leapfrog, Steps::fitted, Reason::given_step},
      {{automatic}, {.given_step = true, .counted = true}, leapfrog, Steps::counted, Reason::given_step},
      {{bm4, rkn12, ros34pw2}, {.given_step = true, .counted = true}, automatic, Steps::counted},  // given steps are not controlled
      {{bm4, rkn12, ros34pw2}, {.given_step = true}, automatic, Steps::fitted},
      {{rkn12}, {.damped = true}, dop853, Steps::controlled, Reason::damping},
      {{bm4}, {.damped = true}, automatic, Steps::fitted},
      {{rkn12, bm4}, {.damped = true, .dashpots = true}, dop853, Steps::controlled, Reason::damping},
      {{central_difference}, {.damped = true, .dashpots = true}, leapfrog, Steps::fitted, Reason::damping},
  });
}

TEST(obstacles_out_of_reach_change_nothing_but_that_the_way_back_is_kept) {
  using enum Method;
  const Facts near = beside(false, 10);
  Facts met = near;
  met.came_upon_obstacle = true;
  require({
      {{leapfrog}, near, automatic, Steps::fitted},
      {{bm4}, near, automatic, Steps::fitted, Reason::asked, Rollback::from_obstacle},
      {{automatic}, near, leapfrog, Steps::by_trials, Reason::asked, Rollback::from_obstacle},
      {{floating_frame}, near, automatic, Steps::controlled, Reason::asked, Rollback::from_obstacle},
      {{central_difference}, {.obstacles = true}, automatic, Steps::fitted},  // as published, it does not look for them
      {{dop853}, met, leapfrog, Steps::doubled, Reason::contact},             // then it is planned as within reach
  });
}

TEST(within_reach_leapfrog_runs_every_stretch_twice_and_given_steps_stay_given) {
  using enum Method;
  Facts touching = beside(true, 10), given = touching, counted = touching, stiff = beside(true, 1e4);
  given.given_step = counted.given_step = counted.counted = stiff.given_step = stiff.counted = true;
  require({
      {{leapfrog}, touching, automatic, Steps::doubled},
      {{automatic, bm4, rkn12, dop853, ros34pw2, floating_frame}, touching, leapfrog, Steps::doubled, Reason::contact},
      {{bm4}, given, leapfrog, Steps::fitted, Reason::contact},
      {{bm4}, counted, leapfrog, Steps::counted, Reason::contact},
      {{bm4}, stiff, leapfrog, Steps::counted, Reason::contact},
  });
}

TEST(stiff_bodies_beside_obstacles_fly_strike_and_rest_and_damped_ones_creep) {
  using enum Method;
  Facts damped = beside(true, 1e4), lasting = beside(true, 1.01 * thresholds::stiff_contact_of_long_runs), forever = lasting;
  damped.damped = damped.dashpots = true;
  Facts given = damped;
  given.given_step = true;
  lasting.length = 1.01 * thresholds::long_contact / *lasting.stiffness;  // stiff in short communication steps too if the run is long
  forever.stiffness = thresholds::stiff_contact_of_long_runs;
  forever.length = 1e6;
  require({
      {{automatic, ros34pw2, floating_frame, backward_euler}, beside(true, 1e4), backward_euler, Steps::impacts, Reason::stiff_contact},
      {{leapfrog}, beside(true, 1e4), automatic, Steps::doubled},
      {{bm4, rkn12, dop853}, beside(true, 1e4), leapfrog, Steps::doubled, Reason::contact},
      {{automatic, ros34pw2}, damped, sdirk2, Steps::damped, Reason::damped_contact},
      {{dop853}, damped, leapfrog, Steps::doubled, Reason::contact},
      {{automatic}, given, leapfrog, Steps::fitted, Reason::contact},
      {{backward_euler}, damped, automatic, Steps::implicit},  // impacts are to be passed over
      {{automatic}, beside(true, thresholds::stiff_contact), leapfrog, Steps::doubled, Reason::contact},
      {{automatic}, beside(true, 1.01 * thresholds::stiff_contact), backward_euler, Steps::impacts, Reason::stiff_contact},
      {{automatic}, beside(true, thresholds::stiffest), leapfrog, Steps::doubled, Reason::contact},
      {{automatic}, beside(true, 1.01 * thresholds::stiff_contact_of_long_runs), leapfrog, Steps::doubled, Reason::contact},
      {{automatic}, lasting, backward_euler, Steps::impacts, Reason::stiff_contact},
      {{automatic}, forever, leapfrog, Steps::doubled, Reason::contact},
  });
}

TEST(out_of_reach_the_modes_carry_a_stiff_body_if_they_can) {
  using enum Method;
  Facts rings = beside(false, 1e4), dull = rings, pinned = rings;
  rings.rings = true;
  dull.rings = false;
  pinned.pins = true;  // which is known without a look at its modes, as is what is soft
  require({
      {{automatic}, rings, backward_euler, Steps::impacts, Reason::stiff_contact, Rollback::never, true},
      {{automatic}, dull, leapfrog, Steps::by_trials, Reason::asked, Rollback::from_obstacle},
      {{automatic}, pinned, leapfrog, Steps::by_trials, Reason::asked, Rollback::from_obstacle},
      {{ros34pw2}, beside(false, 1e4), automatic, Steps::controlled, Reason::asked, Rollback::from_obstacle},
      {{automatic}, beside(false, 10), leapfrog, Steps::by_trials, Reason::asked, Rollback::from_obstacle},
  });
}

TEST(a_plan_asks_for_the_facts_that_it_lacks_one_after_the_other) {
  const Method any = Method::automatic, flying = Method::floating_frame;
  CHECK(plan({.asked = any, .obstacles = true}).want == Want::within_reach);
  CHECK(plan({.asked = any, .obstacles = true, .within_reach = true}).want == Want::stiffness);
  CHECK(plan({.asked = any, .obstacles = true, .within_reach = true, .stiffness = 1e4}).want == Want::nothing);
  CHECK(plan({.asked = any, .obstacles = true, .within_reach = false}).want == Want::stiffness);
  CHECK(plan({.asked = any, .obstacles = true, .within_reach = false, .stiffness = 1e4}).want == Want::rings);
  CHECK(plan({.asked = flying, .obstacles = true}).want == Want::clear);
  CHECK(plan({.asked = flying, .obstacles = true, .clear = true}).want == Want::nothing);
  CHECK(plan({.asked = flying, .obstacles = true, .clear = false}).want == Want::within_reach);
}

TEST(every_plan_ends) {
  for (Method method : all)
    for (int bits = 0; bits < 256; ++bits) {
      const auto bit = [&](int i) { return (bits >> i & 1) != 0; };
      Facts facts{
          .asked = method, .given_step = bit(0), .counted = bit(0) && bit(1), .damped = bit(2), .obstacles = bit(3), .pins = bit(4)};
      int rounds = 0;
      for (Plan p = plan(facts); p.want != Want::nothing || p.rollback != Rollback::never; p = plan(facts)) {
        if (p.want == Want::clear) facts.clear = bit(5);
        if (p.want == Want::within_reach) facts.within_reach = bit(6);
        if (p.want == Want::rings) facts.rings = bit(5);
        if (p.want == Want::stiffness) facts.stiffness = bit(7) ? 1e4 : 1;
        if (p.want == Want::nothing && p.rollback == Rollback::from_obstacle) facts.came_upon_obstacle = true;
        if (++rounds > 8) break;
      }
      CHECK(rounds <= 8);
    }
}

TEST(given_steps_near_obstacles_are_planned_one_by_one_for_methods_that_do_not_know_them) {
  const auto one_by_one = [](Method method, bool obstacles) {
    return plans_every_given_step({.asked = method, .given_step = true, .counted = true, .obstacles = obstacles});
  };
  CHECK(one_by_one(Method::bm4, true) && !one_by_one(Method::bm4, false));
  for (Method method : {Method::automatic, Method::leapfrog, Method::central_difference}) CHECK(!one_by_one(method, true));
}

TEST(implicit_steps_are_tried_where_stable_steps_are_many) {
  CHECK(!implicit_may_pay(2 * thresholds::stiff) && implicit_may_pay(2.1 * thresholds::stiff));
  CHECK(implicit_may_win(79, 100) && !implicit_may_win(81, 100));
  CHECK(implicit_method(false, 1e4, true) == Method::floating_frame);
  CHECK(implicit_method(true, 1e4, true) == Method::ros34pw2);
  CHECK(implicit_method(false, 100, true) == Method::ros34pw2);
  CHECK(implicit_method(false, 1e4, false) == Method::ros34pw2);
  CHECK(too_loud(4, 1) && !too_loud(2, 1));
  CHECK(quiet(0.2, 1) && !quiet(0.4, 1));
}

TEST(races_are_won_by_an_implicit_candidate_that_did_it_by_leapfrog_at_its_limit_or_by_clearly_less_work) {
  const auto wins = [](const Candidates& candidates, Method method, Reason reason) {
    return best_of(candidates).method == method && best_of(candidates).reason == reason;
  };
  Candidates candidates;
  candidates.least = candidates.leapfrog = 100;
  candidates.implicit = Method::ros34pw2;
  CHECK(best_of(candidates).method == Method::leapfrog);
  candidates.implicit_work = 70;
  CHECK(wins(candidates, Method::ros34pw2, Reason::quiet_stiffness));
  candidates.implicit = Method::floating_frame;
  CHECK(wins(candidates, Method::floating_frame, Reason::free_flight) && best_of(candidates).work == 70);

  Candidates limit;
  limit.least = 100;
  limit.leapfrog = 170;
  limit.bm4 = 1;
  CHECK(leapfrog_is_enough(limit) && wins(limit, Method::leapfrog, Reason::stability));

  Candidates other;
  other.least = 100;
  other.leapfrog = 1000;
  other.adaptive = Method::rkn12;
  other.adaptive_work = 500;
  other.bm4 = 450;
  CHECK(wins(other, Method::bm4, Reason::least_work));
  other.before = Method::rkn12;
  CHECK(best_of(other).method == Method::rkn12);
  other.bm4 = 400;
  CHECK(best_of(other).method == Method::bm4);
  other.before = Method::leapfrog;
  other.leapfrog = 479;
  CHECK(wins(other, Method::leapfrog, Reason::least_work));
}

TEST(samples_of_the_surface_are_met_as_control_points_are_but_for_the_central_difference) {
  for (const Method asked : all)
    for (Facts facts : {beside(true, 1e4), beside(false, 10)})
      for (const bool given : {false, true}) {
        facts.asked = asked;
        facts.rings = true;
        facts.given_step = given;
        Facts of_surface = facts;
        of_surface.surface = true;
        if (asked == Method::central_difference) facts.asked = Method::leapfrog;
        const Plan points = plan(facts), samples = plan(of_surface);
        CHECK(points.want == samples.want && points.method == samples.method && points.steps == samples.steps);
        if (asked == Method::central_difference) CHECK(samples.method == Method::leapfrog && samples.reason == Reason::contact);
      }
}
