#include "stepping/plan.hpp"

#include "check.hpp"
#include "kit/thresholds.hpp"
#include "methods/traits.hpp"

using namespace softffd;

namespace {

/// A scene with obstacles out of reach.
Facts near(Method asked) {
  Facts facts;
  facts.asked = asked;
  facts.obstacles = true;
  facts.clear = true;
  facts.within_reach = false;
  facts.stiffness = 10;
  return facts;
}

Facts touching(Method asked) {
  Facts facts = near(asked);
  facts.clear = false;
  facts.within_reach = true;
  return facts;
}

Facts stiff(Method asked) {
  Facts facts = touching(asked);
  facts.stiffness = 1e4;
  return facts;
}

bool is(const Plan& p, Method method, Steps steps, Reason reason, Retreat retreat = Retreat::never) {
  return p.want == Want::nothing && p.method == method && p.steps == steps && p.reason == reason && p.retreat == retreat;
}

constexpr Method all[] = {Method::automatic, Method::central_difference, Method::leapfrog,       Method::bm4,           Method::rkn12,
                          Method::dop853,    Method::ros34pw2,           Method::backward_euler, Method::floating_frame};

}  // namespace

TEST(without_obstacles_everybody_gets_what_was_asked_for) {
  for (Method method : {Method::central_difference, Method::leapfrog, Method::bm4})
    CHECK(is(plan({.asked = method}), method, Steps::fitted, Reason::asked));
  for (Method method : {Method::rkn12, Method::dop853, Method::ros34pw2, Method::floating_frame})
    CHECK(is(plan({.asked = method}), method, Steps::controlled, Reason::asked));
  CHECK(is(plan({.asked = Method::backward_euler, .given_step = true}), Method::backward_euler, Steps::implicit, Reason::asked));
  CHECK(plan({.asked = Method::backward_euler}).steps == Steps::raced);
}

TEST(automatic_is_a_race_and_with_a_given_step_leapfrog) {
  CHECK(plan({.asked = Method::automatic}).steps == Steps::raced);
  CHECK(is(plan({.given_step = true}), Method::leapfrog, Steps::fitted, Reason::given_step));
  CHECK(is(plan({.given_step = true, .counted = true}), Method::leapfrog, Steps::counted, Reason::given_step));
}

TEST(a_given_step_that_divides_the_stretch_is_counted_and_takes_no_error_control) {
  for (Method method : {Method::bm4, Method::rkn12, Method::ros34pw2}) {
    CHECK(is(plan({.asked = method, .given_step = true, .counted = true}), method, Steps::counted, Reason::asked));
    CHECK(is(plan({.asked = method, .given_step = true}), method, Steps::fitted, Reason::asked));
  }
}

TEST(rkn12_gives_way_to_dop853_where_the_body_is_damped) {
  CHECK(is(plan({.asked = Method::rkn12, .damped = true}), Method::dop853, Steps::controlled, Reason::damping));
  CHECK(is(plan({.asked = Method::bm4, .damped = true}), Method::bm4, Steps::fitted, Reason::asked));
}

TEST(methods_that_cannot_follow_internal_damping_give_way) {
  for (const Method method : {Method::rkn12, Method::bm4})
    CHECK(is(plan({.asked = method, .damped = true, .dashpots = true}), Method::dop853, Steps::controlled, Reason::damping));
  CHECK(
      is(plan({.asked = Method::central_difference, .damped = true, .dashpots = true}), Method::leapfrog, Steps::fitted, Reason::damping));
}

TEST(stiff_bodies_with_internal_damping_take_explicit_steps_beside_obstacles_unless_impacts_are_to_be_passed_over) {
  for (const Method method : {Method::automatic, Method::ros34pw2, Method::backward_euler}) {
    Facts facts = stiff(method);
    facts.damped = facts.dashpots = true;
    const bool over = method == Method::backward_euler;
    CHECK(plan(facts).steps == (over ? Steps::implicit : Steps::doubled));
    CHECK(plan(facts).method == (over ? method : Method::leapfrog));
  }
}

TEST(obstacles_out_of_reach_change_nothing_but_that_the_way_back_is_kept) {
  CHECK(is(plan(near(Method::leapfrog)), Method::leapfrog, Steps::fitted, Reason::asked));
  CHECK(is(plan(near(Method::bm4)), Method::bm4, Steps::fitted, Reason::asked, Retreat::from_obstacle));
  CHECK(is(plan(near(Method::automatic)), Method::leapfrog, Steps::raced, Reason::asked, Retreat::from_obstacle));
  CHECK(is(plan(near(Method::floating_frame)), Method::floating_frame, Steps::controlled, Reason::asked, Retreat::from_obstacle));
}

TEST(the_published_method_does_not_look_for_obstacles) {
  Facts facts{.asked = Method::central_difference, .obstacles = true};
  CHECK(is(plan(facts), Method::central_difference, Steps::fitted, Reason::asked));
}

TEST(a_plan_asks_for_the_facts_that_it_lacks_one_after_the_other) {
  Facts facts{.asked = Method::automatic, .obstacles = true};
  CHECK(plan(facts).want == Want::within_reach);
  facts.within_reach = true;
  CHECK(plan(facts).want == Want::stiffness);
  facts.stiffness = 1e4;
  CHECK(plan(facts).want == Want::nothing);
  Facts far{.asked = Method::automatic, .obstacles = true, .within_reach = false};
  CHECK(plan(far).want == Want::stiffness);
  far.stiffness = 1e4;
  CHECK(plan(far).want == Want::rings);
  Facts flying{.asked = Method::floating_frame, .obstacles = true};
  CHECK(plan(flying).want == Want::clear);
  flying.clear = true;
  CHECK(plan(flying).want == Want::nothing);
  flying.clear = false;
  CHECK(plan(flying).want == Want::within_reach);
}

TEST(within_reach_leapfrog_runs_every_stretch_twice) {
  CHECK(is(plan(touching(Method::leapfrog)), Method::leapfrog, Steps::doubled, Reason::asked));
  for (Method method : {Method::automatic, Method::bm4, Method::rkn12, Method::dop853, Method::ros34pw2, Method::floating_frame})
    CHECK(is(plan(touching(method)), Method::leapfrog, Steps::doubled, Reason::contact));
}

TEST(within_reach_given_steps_stay_given) {
  Facts facts = touching(Method::bm4);
  facts.given_step = true;
  CHECK(is(plan(facts), Method::leapfrog, Steps::fitted, Reason::contact));
  facts.counted = true;
  CHECK(is(plan(facts), Method::leapfrog, Steps::counted, Reason::contact));
  facts.stiffness = 1e4;
  CHECK(is(plan(facts), Method::leapfrog, Steps::counted, Reason::contact));
}

TEST(what_came_upon_an_obstacle_is_planned_as_within_reach) {
  Facts facts = near(Method::dop853);
  facts.came_upon_obstacle = true;
  CHECK(is(plan(facts), Method::leapfrog, Steps::doubled, Reason::contact));
}

TEST(stiff_bodies_beside_obstacles_fly_strike_and_rest) {
  for (Method method : {Method::automatic, Method::ros34pw2, Method::floating_frame, Method::backward_euler})
    CHECK(is(plan(stiff(method)), Method::backward_euler, Steps::impacts, Reason::stiff_contact));
  for (Method method : {Method::leapfrog, Method::bm4, Method::rkn12, Method::dop853}) CHECK(plan(stiff(method)).steps == Steps::doubled);
}

TEST(what_is_stiff_has_a_lower_and_an_upper_bound) {
  Facts facts = stiff(Method::automatic);
  facts.stiffness = thresholds::stiff_contact;
  CHECK(plan(facts).steps == Steps::doubled);
  facts.stiffness = 1.01 * thresholds::stiff_contact;
  CHECK(plan(facts).steps == Steps::impacts && !plan(facts).rings);
  facts.stiffness = thresholds::stiffest;
  CHECK(plan(facts).steps == Steps::doubled);
}

TEST(a_body_is_stiff_in_short_communication_steps_too_if_the_run_is_long) {
  Facts facts = stiff(Method::automatic);
  facts.stiffness = 1.01 * thresholds::stiff_contact_of_long_runs;
  CHECK(plan(facts).steps == Steps::doubled);
  facts.length = 1.01 * thresholds::long_contact / *facts.stiffness;
  CHECK(plan(facts).steps == Steps::impacts);
  facts.stiffness = thresholds::stiff_contact_of_long_runs;
  facts.length = 1e6;
  CHECK(plan(facts).steps == Steps::doubled);
}

TEST(out_of_reach_the_modes_carry_a_stiff_body_if_they_can) {
  Facts facts = stiff(Method::automatic);
  facts.within_reach = false;
  facts.rings = true;
  CHECK(plan(facts).steps == Steps::impacts && plan(facts).rings);
  facts.rings = false;
  CHECK(plan(facts).steps == Steps::raced);
  facts.rings.reset();
  facts.pins = true;
  CHECK(plan(facts).steps == Steps::raced);
  facts.pins = false;
  facts.asked = Method::ros34pw2;
  CHECK(plan(facts).steps == Steps::controlled);
  facts.asked = Method::automatic;
  facts.stiffness = 10;
  CHECK(plan(facts).steps == Steps::raced);
}

TEST(every_plan_ends) {
  for (Method method : all)
    for (int bits = 0; bits < 256; ++bits) {
      const auto bit = [&](int i) { return (bits >> i & 1) != 0; };
      Facts facts{
          .asked = method, .given_step = bit(0), .counted = bit(0) && bit(1), .damped = bit(2), .obstacles = bit(3), .pins = bit(4)};
      int rounds = 0;
      for (Plan p = plan(facts); p.want != Want::nothing || p.retreat != Retreat::never; p = plan(facts)) {
        if (p.want == Want::clear) facts.clear = bit(5);
        if (p.want == Want::within_reach) facts.within_reach = bit(6);
        if (p.want == Want::rings) facts.rings = bit(5);
        if (p.want == Want::stiffness) facts.stiffness = bit(7) ? 1e4 : 1;
        if (p.want == Want::nothing && p.retreat == Retreat::from_obstacle) facts.came_upon_obstacle = true;
        if (++rounds > 8) break;
      }
      CHECK(rounds <= 8);
    }
}

TEST(given_steps_near_obstacles_are_planned_one_by_one_for_methods_that_do_not_know_them) {
  Facts facts{.asked = Method::bm4, .given_step = true, .counted = true, .obstacles = true};
  CHECK(plans_every_given_step(facts));
  for (Method method : {Method::automatic, Method::leapfrog, Method::central_difference}) {
    Facts other = facts;
    other.asked = method;
    CHECK(!plans_every_given_step(other));
  }
  facts.obstacles = false;
  CHECK(!plans_every_given_step(facts));
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

TEST(an_implicit_candidate_that_did_it_wins) {
  Contest contest;
  contest.least = contest.leapfrog = 100;
  contest.implicit = Method::ros34pw2;
  CHECK(settle(contest).method == Method::leapfrog);
  contest.implicit_work = 70;
  CHECK(settle(contest).method == Method::ros34pw2 && settle(contest).reason == Reason::quiet_stiffness);
  contest.implicit = Method::floating_frame;
  CHECK(settle(contest).reason == Reason::free_flight && settle(contest).work == 70);
}

TEST(leapfrog_at_its_stability_limit_is_not_challenged) {
  Contest contest;
  contest.least = 100;
  contest.leapfrog = 170;
  contest.bm4 = 1;
  CHECK(leapfrog_is_enough(contest));
  CHECK(settle(contest).method == Method::leapfrog && settle(contest).reason == Reason::stability);
}

TEST(a_challenger_needs_clearly_less_work_than_the_last_winner) {
  Contest contest;
  contest.least = 100;
  contest.leapfrog = 1000;
  contest.adaptive = Method::rkn12;
  contest.adaptive_work = 500;
  contest.bm4 = 450;
  CHECK(settle(contest).method == Method::bm4 && settle(contest).reason == Reason::least_work);
  contest.before = Method::rkn12;
  CHECK(settle(contest).method == Method::rkn12);
  contest.bm4 = 400;
  CHECK(settle(contest).method == Method::bm4);
  contest.before = Method::leapfrog;
  contest.leapfrog = 479;
  CHECK(settle(contest).method == Method::leapfrog && settle(contest).reason == Reason::least_work);
}

TEST(samples_of_the_surface_are_met_as_control_points_are_but_for_the_central_difference) {
  for (const Method asked : all) {
    for (const auto& situation : {stiff(asked), near(asked)}) {
      Facts facts = situation;
      facts.rings = true;
      for (const bool given : {false, true}) {
        facts.given_step = given;
        Facts of_surface = facts;
        of_surface.surface = true;
        if (asked == Method::central_difference) facts.asked = Method::leapfrog;
        const Plan points = plan(facts), samples = plan(of_surface);
        CHECK(points.want == samples.want && points.method == samples.method && points.steps == samples.steps);
      }
    }
  }
  Facts facts = stiff(Method::central_difference);
  facts.surface = true;
  CHECK(plan(facts).method == Method::leapfrog && plan(facts).reason == Reason::contact);
}
