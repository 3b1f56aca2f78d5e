#include "messages/messages.hpp"

#include <vector>

#include "instances.hpp"

using namespace softffd::fmi;

namespace {

std::vector<std::string> heard;

void hear(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String category, fmi2String message, ...) {
  heard.push_back(std::string(category) + ": " + message);
}

/// How many messages hold a text.
int count(const std::string& text) {
  int n = 0;
  for (const std::string& message : heard) n += message.find(text) != message.npos;
  return n;
}

struct Run {
  std::unique_ptr<Instance> made;
  Instance& instance = *made;

  Run(const std::string& initial, const std::string& parts, bool logging = true)
      : made(instance_of(small_scene::Box{.initial = initial}.text(parts), logging, hear)) {
    heard.clear();
  }
  void start() { softffd::fmi::start(instance); }
  void steps(int first, int last) { softffd::fmi::run(instance, first, last); }
};

const std::string turned_inside_out = "-1 1 1 0 0 0 0 0 0 0 0 0", as_drawn = "1 1 1 0 0 0 0 0 0 0 0 0";

}  // namespace

TEST(that_a_run_was_set_up_is_part_of_its_state) {
  for (const bool given : {false, true}) {
    Run run(as_drawn, "damping 0.1\n"), other(as_drawn, "damping 0.1\n");
    if (given) run.instance.setup_experiment(2, 0, 5);
    other.instance.load_state(run.instance.save_state());
    other.instance.enter_initialization();
    CHECK(count("fmi2SetupExperiment was not called") == !given);
  }
}

TEST(what_is_not_counted_while_nobody_listens_is_told_as_soon_as_somebody_does) {
  Run run(turned_inside_out, "damping 0.1\n", false);
  run.start();
  run.steps(0, 1);
  CHECK(heard.empty());
  run.instance.logger.switch_categories(true, {});
  run.steps(1, 2);
  CHECK(count("inverted") == 1);
}

TEST(a_tolerance_that_an_obstacle_does_not_let_hold_is_told_once_with_the_error) {
  const std::string falls = "1 1 1 0 0 0.003 0 0 -1 0 3 0", table = "plane table fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.5\nmethod 3\n";
  for (const bool kept : {true, false}) {
    Run run(falls, "damping 0.1\n" + table + (kept ? "tolerance 1e-3\n" : "tolerance 1e-12\n"));
    run.start();
    run.steps(0, 2);
    CHECK(count("the tolerance could not be met in contact: the result may be wrong by ") == !kept);
  }
}

TEST(what_is_estimated_has_two_digits_and_a_bound_stays_within_them) {
  CHECK(estimate(0.0294339796) == "0.029" && estimate(1234.5) == "1200" && estimate(9.96e-6) == "1e-05" && estimate(0) == "0");
  for (const double bound : {1.001e-3, 1.04e-3, 9.99e-3, 0.0294339796, 3.0})
    CHECK(std::stod(within(bound)) <= bound && std::stod(within(bound)) > 0.85 * bound);
}

TEST(trouble_names_the_pin_and_the_obstacle) {
  const std::string planes = "plane wall fixed 5 0 0 -1 0 0 0 0 0 0 0 0 0\nplane lid input 0 0 0.95 0 0 -1 0 0 0 0 0 0 0\n";
  const auto refused = [&](Family family, double value, const std::string& parts) {
    Run run(as_drawn, "damping 0.1\npin base fixed 0\npin hand input 26\n" + parts);
    set_value(run.instance, family, value);
    return refusal([&] {
      run.start();
      run.steps(0, 1);
    });
  };
  const std::string initial = "the initial state: at time 0 s: ",
                    contradict = "; the motions of the pin and the obstacle contradict each other";
  CHECK(refused(Family::damping, 0.2, planes) == initial + "a control point of pin.hand is behind plane.lid" + contradict);
  CHECK(refused(Family::pin_orientation, 0, "").find(initial + "pin.hand: the orientation is the zero quaternion; wanted") == 0);
  CHECK(refused(Family::mass, 1e308, "gravity 0 0 -9.81\nenergy\n") ==
        initial + "a number is not finite: masses, forces, speeds or stiffness are too large");
}

TEST(a_pin_that_starts_off_its_place_is_told_by_name) {
  for (const std::string moves : {"fixed", "input"})
    for (const bool off : {true, false}) {
      Run run(off ? "1 1 1 0 0 0.25 0 0 0 0 0 0" : "1.1 1 1 0 0 0 0 0 0 0 0 0", "damping 0.1\npin base " + moves + " 0 1\n");
      run.start();
      CHECK(count("logStatusWarning: at time 0 s: pin base holds its control points up to 0.25 m from the initial position of the body") ==
            off);
    }
}
