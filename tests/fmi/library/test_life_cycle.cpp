/// The C interface driven as a host drives it; meant for sanitizers above all.
#include <cfenv>
#include <cmath>
#include <thread>

#include "host.hpp"
#include "instances.hpp"
#include "life_cycle.hpp"

namespace {

const std::string& box_on_ground() {
  static const std::string uri = small_scene::Box{.side = 4, .mass = 0.015625, .initial = "1 1 1 0 0 0.1 1 0 0 0 0 0"}.resources(
      "damping 0.01\ngravity 0 0 -9.81\nplane ground fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.4\nreactions\nenergy\nsolver\n");
  return uri;
}

fmi2Component box(const char* guid = "{g}") { return component::instantiate(box_on_ground(), fmi2False, guid); }

std::vector<double> run(fmi2Component c, int steps) {
  CHECK(component::begin(c) == fmi2OK);
  for (int i = 0; i < steps; ++i) CHECK(component::step(c, i) == fmi2OK);
  return component::positions(c, 64);
}

}  // namespace

TEST(floating_point_exceptions_are_the_hosts_own) {
  fmi2Component c = box();
  std::feclearexcept(FE_ALL_EXCEPT);
  run(c, 2);
  CHECK(std::fetestexcept(FE_ALL_EXCEPT) == 0);
  std::feraiseexcept(FE_DIVBYZERO);
  CHECK(component::step(c, 2) == fmi2OK);
  CHECK(std::fetestexcept(FE_ALL_EXCEPT) == FE_DIVBYZERO);
  std::feclearexcept(FE_ALL_EXCEPT);
  fmi2FreeInstance(c);
}

TEST(threads_and_resets_give_the_same_bits) {
  fmi2Component one = box();
  CHECK(one != nullptr);
  const std::vector<double> expected = run(one, 50);
  CHECK(fmi2Reset(one) == fmi2OK);
  CHECK(run(one, 50) == expected);
  fmi2FreeInstance(one);
  std::vector<std::vector<double>> results(4);
  std::vector<std::thread> threads;
  for (auto& result : results)
    threads.emplace_back([&result] {
      fmi2Component c = box();
      result = run(c, 50);
      fmi2FreeInstance(c);
    });
  for (auto& thread : threads) thread.join();
  for (const auto& result : results) CHECK(result == expected);
}

TEST(calls_in_the_wrong_state_or_on_dead_handles_are_errors) {
  CHECK(fmi2DoStep(nullptr, 0, 1, fmi2True) == fmi2Error);
  fmi2Component c = box();
  CHECK(component::step(c, 0) == fmi2Error);
  CHECK(fmi2Reset(c) == fmi2OK);
  run(c, 1);
  fmi2FreeInstance(c);
  CHECK(component::step(c, 1) == fmi2Error);
  fmi2FreeInstance(c);
  CHECK(box("{another}") == nullptr);
}

TEST(a_refused_value_changes_nothing) {
  fmi2Component c = box();
  const fmi2ValueReference references[] = {26u << 24, 25u << 24};
  const double values[] = {5.0, -1.0};
  CHECK(fmi2SetReal(c, references, 2, values) == fmi2Error);
  CHECK(fmi2Reset(c) == fmi2OK);
  CHECK(component::begin(c) == fmi2OK);
  double stiffness = 0;
  CHECK(fmi2GetReal(c, references, 1, &stiffness) == fmi2OK);
  CHECK(stiffness == 1000.0);
  fmi2FreeInstance(c);
}

TEST(hundreds_of_instances_come_and_go) {
  for (int i = 0; i < 300; ++i) fmi2FreeInstance(box());
}

namespace {

std::string refused_step(const softffd::fmi::Times& times, double time, double step) {
  return softffd::fmi::refusal([&] { times.check_step(time, step); });
}

}  // namespace

TEST(a_step_goes_on_from_the_point_reached_to_rounding) {
  const softffd::fmi::Times times{.start = 100, .now = 103};
  for (double off : {0.0, 1e-9, -1e-9}) CHECK(refused_step(times, 103 + off, 0.01).empty());
  for (double off : {1e-6, -1e-6, 0.01, double(NAN), double(INFINITY)})
    CHECK(refused_step(times, 103 + off, 0.01).find("currentCommunicationPoint: wanted 103 s") == 0);
  CHECK(!refused_step(times, 103 + 1e-9, 1e-8).empty());  // a tenth of the step
}

TEST(a_step_has_a_length_and_ends_within_the_run) {
  const softffd::fmi::Times times{.start = 0, .now = 0.9, .stop = 1};
  for (double step : {0.0, -0.1, double(NAN), double(INFINITY)})
    CHECK(refused_step(times, 0.9, step).find("communicationStepSize: wanted > 0 s") == 0);
  CHECK(refused_step(times, 0.9, 0.1).empty() && refused_step(times, 0.9, 0.1 + 1e-10).empty());
  CHECK(refused_step(times, 0.9, 0.1001) == "a step to 1.0001 s goes past the stop time 1 s");
}

TEST(the_horizon_is_the_length_of_the_run_or_the_one_expected) {
  CHECK((softffd::fmi::Times{.start = 2, .now = 2, .stop = 5}.horizon(7)) == 3);
  CHECK((softffd::fmi::Times{.start = 2, .now = 2}.horizon(7)) == 7);
}
