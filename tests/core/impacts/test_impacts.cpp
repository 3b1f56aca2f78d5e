/// Stiff boxes that strike an obstacle, against references of explicit steps down to a 128th of the stable one, made by another program.
#include "impacts/impacts.hpp"

#include "check.hpp"
#include "estimate.hpp"
#include "stiff_box.hpp"

using namespace softffd;

namespace {

struct Known {
  const char* name;
  StiffBox box;
  Vec3 end;            ///< centre of mass at the end of the run [m]
  double error, work;  ///< allowed [m]; in evaluations of the forces at H = 10 ms, the modes apart
};

const Vec3 about_x = Vec3::UnitX();

const Known one_impact[] = {
    {"flat", {.stiffness = 1e7}, {0.5, 0.5, 0.6176278}, 3e-5, 4000},
    {"tilted", {.stiffness = 1e6, .damping = 0.001, .spin = 0.5 * about_x}, {0.5, 0.6292702, 0.6421043}, 3e-5, 4000},
    {"stiffer", {.stiffness = 1e9, .damping = 0.05, .spin = 0.5 * about_x, .length = 0.45}, {0.5, 0.5708908, 0.568079}, 3e-5, 4000},
    {"spinning", {.stiffness = 1e8, .damping = 0.05, .spin = 5 * about_x}, {0.5, 0.3894143, 0.7780038}, 3e-5, 4000},
};

const Known two_impacts[] = {
    {"damped", {.stiffness = 1e7, .damping = 0.05, .spin = 0.5 * about_x, .length = 0.6}, {0.5, 0.621512, 0.601605}, 1e-4, 20000},
    {"undamped", {.stiffness = 1e6, .spin = 0.5 * about_x, .length = 0.6}, {0.5, 0.9077456, 0.758194}, 1e-4, 20000},
};

/// How far the centre of mass is from a place, along any axis [m].
double off(const SoftBody& body, const StiffBox& box, const Vec3& place) { return (centre(body, box) - place).cwiseAbs().maxCoeff(); }

/// The box at the end of its run.
SoftBody ran(const StiffBox& box, double H = 0.01, const std::function<void(Settings&)>& more = {}) {
  SoftBody body = box.start(box.definition(), more);
  CHECK(run_for(body, box.length, H));
  return body;
}

void expect(const Known& known, const std::vector<double>& steps) {
  for (const double H : steps) {
    SoftBody body = known.box.start();
    double lowest = 1;
    const bool went = run_for(body, known.box.length, H, [&] { lowest = std::min(lowest, body.state().x.col(2).minCoeff()); });
    CHECK(went && lowest >= 0);
    const double error = off(body, known.box, known.end);
    if (error > known.error) std::printf("    %s, H = %g s: error %.3g m\n", known.name, H, error);
    CHECK(error <= known.error);
    if (H == 0.01) CHECK(body.run().control.work <= known.work);
  }
}

}  // namespace

TEST(an_impact_is_right_at_every_stiffness_and_every_communication_step_at_the_same_cost) {
  for (const Known& known : one_impact) expect(known, {0.05, 0.01});
  expect(one_impact[0], {0.001});
}

TEST(the_phase_of_the_vibrations_is_kept_for_the_second_impact) {
  for (const Known& known : two_impacts) expect(known, {0.05, 0.01});
}

TEST(a_communication_step_that_changes_every_time_gives_the_same) {
  const StiffBox& box = one_impact[1].box;
  SoftBody body = box.start();
  double time = 0;
  for (int i = 0; time < box.length; ++i) {
    const double H = std::min(box.length - time, 0.0007 * (1 + 7 * (i % 5)));
    CHECK(body.advance(H) == StepStatus::ok);
    time += H;
  }
  CHECK(off(body, box, one_impact[1].end) <= 3e-5);
}

TEST(other_units_give_the_same_numbers) {
  const StiffBox& box = one_impact[1].box;
  StiffBox scaled = box;  // lengths in quarters of a metre, masses in half kilograms
  scaled.size = 4;
  scaled.height = 4 * box.height;
  scaled.mass = 2;
  scaled.stiffness = 2 * box.stiffness;
  scaled.damping = 2 * box.damping;
  scaled.gravity = 4 * box.gravity;
  CHECK(distance(ran(scaled).state().x / 4, ran(box).state().x) < 1e-9);
}

TEST(a_mirrored_box_moves_as_its_mirror_image) {
  StiffBox box = one_impact[1].box;
  box.velocity = Vec3(0.3, 0.2, 0);
  StiffBox mirrored = box;
  mirrored.velocity[1] *= -1;
  mirrored.spin *= -1;
  const Points x = ran(box).state().x, y = ran(mirrored).state().x;
  Points image(64, 3);
  for (int p = 0; p < 64; ++p) {
    const int mirror = p + 4 * (3 - 2 * (p / 4 % 4));  // the last along y for the first
    set_row(image, mirror, Vec3(x(p, 0), 1 - x(p, 1), x(p, 2)));
  }
  CHECK(distance(image, y) < 1e-5);
}

TEST(a_plane_that_comes_up_strikes_as_a_box_that_falls_on_it) {
  StiffBox box = one_impact[1].box;
  box.gravity = box.damping = 0;  // air would know which of the two moves
  box.velocity = Vec3(0, 0, -2);
  StiffBox still = box;
  still.velocity.setZero();
  const SoftBody struck = ran(still, 0.01, [](Settings& settings) { settings.planes[0].velocity = Vec3(0, 0, 2); });
  CHECK(off(struck, still, centre(ran(box), box) + Vec3(0, 0, 0.8)) < 3e-5);
}

TEST(obstacles_loads_damping_and_lattices_of_every_kind_are_as_by_fine_leapfrog) {
  struct Kind {
    const char* name;
    StiffBox box;
    std::function<void(Definition&)> defined = [](Definition&) {};
    std::function<void(Settings&)> set = [](Settings&) {};
    std::function<void(Settings&, double)> at = [](Settings&, double) {};  // the time [s]
  };
  const StiffBox tilted{.stiffness = 1e6, .height = 0.15, .velocity = Vec3(0.3, 0.2, 0), .spin = Vec3(0.7, 0.3, 0.1), .length = 0.24};
  const auto counted = [&](std::array<int, 3> counts, double stiffness) {
    StiffBox box = tilted;
    box.counts = counts;
    box.stiffness = stiffness;
    return box;
  };
  std::vector<Kind> kinds{
      {"a plane that turns", tilted, {}, [](Settings& s) { s.planes[0].angular_velocity = Vec3(0.3, -0.4, 0.2); }},
      {"a plane that comes up and speeds up", tilted, {}, [](Settings& s) { s.planes[0].acceleration = Vec3(0, 0, 3); }},
      {"two planes", tilted, [](Definition& d) { d.planes = 2; },
       [](Settings& s) {
         s.planes[1].normal = Vec3(-1, 0.2, 0.3);
         s.planes[1].point = Vec3(1.04, 0, 0);
         s.planes[1].friction = 0.2;
       }},
      {"a load that grows",
       tilted,
       {},
       {},
       [](Settings& s, double time) {
         for (int axis = 0; axis < 3; ++axis) {
           s.force.change().row(5)[axis] = 40 * time * (axis - 1);
           s.force_rate.change().row(5)[axis] = 40 * (axis - 1);
         }
       }},
      {"damped on one side", tilted,
       [](Definition& d) { d.regions.push_back({.points = {0, 4, 8, 12, 16, 20}, .stiffness = {}, .damping = 0.5}); }},
      {"2 x 2 x 2", counted({2, 2, 2}, 1e8)},
      {"3 x 5 x 4", counted({3, 5, 4}, 1e6)},
  };
  if (check::thorough) kinds.push_back({"6 x 6 x 6", counted({6, 6, 6}, 1e6)});
  for (const Kind& kind : kinds) {
    const auto end = [&](Method method, double step) {
      Definition definition = kind.box.definition();
      if (kind.defined) kind.defined(definition);
      SoftBody body = kind.box.start(definition, kind.set);
      body.settings.method = method;
      body.settings.step = step;
      for (int i = 0; i < 24; ++i) {
        if (kind.at) kind.at(body.settings, 0.01 * i);
        CHECK(body.advance(0.01) == StepStatus::ok);
      }
      if (step == 0) CHECK(body.run().physical.error.size > 0);  // it went by windows and flights
      return std::pair(body.state().x, body.readings().stable_step());
    };
    const auto [x, stable] = end(Method::automatic, 0);
    const double error = distance(x, end(Method::leapfrog, stable / 16).first);
    if (error > kind.box.tolerance) std::printf("  %s: %.2g m\n", kind.name, error);
    CHECK(error <= kind.box.tolerance);
  }
}

TEST(a_corner_that_passes_through_a_plane_within_a_step_is_seen) {
  const StiffBox box{.stiffness = 1e7, .height = 0.2035, .spin = Vec3(0, 22.43995, 0), .friction = 0.3, .gravity = 0, .length = 0.2};
  expect({"passing", box, {0.6382258, 0.5, 1.1644624}, 3e-5, 4000}, {0.2, 0.05, 0.01});
}

TEST(sliding_is_exact_in_steps_of_any_length_and_sticking_sticks) {
  const StiffBox slides{.stiffness = 1e9, .height = 0, .velocity = Vec3(1, 0, 0), .length = 0.5};
  expect({"slides", slides, {0.627421, 0.5, 0.5}, 1e-4, 30000}, {0.05, 0.01});
  const StiffBox sticks{.stiffness = 1e9, .damping = 0.5, .height = 0, .incline = M_PI / 9, .length = 1};
  for (const double H : {0.01, 0.05}) {
    SoftBody body = sticks.start();
    CHECK(run_for(body, 0.1, H));
    const Points begun = body.state().x;
    const Count steps = body.run().physical.steps;
    CHECK(run_for(body, 0.9, H));
    CHECK(distance(body.state().x, begun) < 1e-8);
    CHECK(body.run().physical.steps - steps <= 3 * std::llround(0.9 / H));
    CHECK_NEAR(-body.readings().plane_reaction(0)[2], 9.81 * std::cos(M_PI / 9), 1e-6);
  }
}

TEST(a_light_corner_that_makes_a_soft_body_stiff_bounces_as_it_should) {
  const StiffBox box{.stiffness = 1e3, .height = 0.2, .length = 0.4, .light_corner = 1e-6};
  const SoftBody body = ran(box, 0.05), fine = ran(box, 0.05, [](Settings& settings) {
                                          settings.method = Method::leapfrog;
                                          settings.step = 2e-6;
                                        });
  const int heavy = body.lattice().points() - 1;
  CHECK((body.state().x - fine.state().x).bottomRows(heavy).abs().maxCoeff() < 1e-4);
}

TEST(what_cannot_be_known_is_said) {
  const StiffBox box{.stiffness = 1e9, .damping = 0.05, .spin = 0.5 * about_x, .length = 1.5};
  CHECK(ran(box, 0.05).readings().stated_error() > 1e-2);
  CHECK(ran(one_impact[2].box, 0.05).readings().stated_error() < 1e-4);
}

TEST(the_estimate_is_that_of_the_error_through_an_impact) {
  const Known& known = one_impact[2];
  const Definition definition = known.box.definition();
  SoftBody body = known.box.start(definition);
  ErrorEstimate estimate(definition);
  estimate.initialize(body, 0);
  CHECK(run_for(body, known.box.length, 0.05, [&] { estimate.follow(body, 0.05); }));
  const double error = off(body, known.box, known.end);
  CHECK(estimate.value() > 0.2 * error);
  CHECK(estimate.value() < 10 * std::max(error, 4e-6));
}

TEST(a_snapshot_in_flight_at_an_impact_and_at_rest_goes_on_to_the_bit) {
  const StiffBox box{.stiffness = 1e6, .damping = 0.5, .spin = 5 * about_x, .length = 2.5};
  SoftBody body = box.start(), other = box.start();
  std::vector<Phase> seen;
  for (int i = 0; i < 250; ++i) {
    CHECK(body.advance(0.01) == StepStatus::ok);
    const Phase phase = body.run().physical.stiff.phase;
    if (std::find(seen.begin(), seen.end(), phase) != seen.end()) continue;
    seen.push_back(phase);
    other.restore(body.run(), 0);
    SoftBody first = box.start();
    first.restore(body.run(), 0);
    CHECK(first.advance(0.01) == StepStatus::ok && other.advance(0.01) == StepStatus::ok);
    CHECK((first.state().x == other.state().x).all() && (first.state().v == other.state().v).all());
  }
  CHECK(seen.size() >= 3);
}
