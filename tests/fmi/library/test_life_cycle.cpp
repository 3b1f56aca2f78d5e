/// The C interface driven as a host drives it; meant for sanitizers above all.
#include <cfenv>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

extern "C" {
#include "fmi2Functions.h"
}

#include "check.hpp"
#include "life_cycle.hpp"
#include "small_scene.hpp"

namespace {

const std::string& resources() {
  static const std::string uri = small_scene::Box{.side = 4, .mass = 0.015625, .initial = "1 1 1 0 0 0.1 1 0 0 0 0 0"}.resources(
      "damping 0.01\ngravity 0 0 -9.81\nplane ground fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.4\nreactions\nenergy\nsolver\n");
  return uri;
}

fmi2Component instantiate(const char* guid = "{g}") {
  fmi2CallbackFunctions callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
  return fmi2Instantiate("box", fmi2CoSimulation, guid, resources().c_str(), &callbacks, fmi2False, fmi2False);
}

std::vector<double> run(fmi2Component c, int steps) {
  CHECK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0) == fmi2OK);
  CHECK(fmi2EnterInitializationMode(c) == fmi2OK);
  CHECK(fmi2ExitInitializationMode(c) == fmi2OK);
  for (int i = 0; i < steps; ++i) CHECK(fmi2DoStep(c, i * 0.01, 0.01, fmi2True) == fmi2OK);
  std::vector<fmi2ValueReference> references(192);
  for (unsigned i = 0; i < 192; ++i) references[i] = 60u << 24 | i;
  std::vector<double> positions(192);
  CHECK(fmi2GetReal(c, references.data(), 192, positions.data()) == fmi2OK);
  return positions;
}

}  // namespace

TEST(floating_point_exceptions_are_the_hosts_own) {
  fmi2Component c = instantiate();
  std::feclearexcept(FE_ALL_EXCEPT);
  run(c, 2);
  CHECK(std::fetestexcept(FE_ALL_EXCEPT) == 0);
  std::feraiseexcept(FE_DIVBYZERO);
  CHECK(fmi2DoStep(c, 0.02, 0.01, fmi2True) == fmi2OK);
  CHECK(std::fetestexcept(FE_ALL_EXCEPT) == FE_DIVBYZERO);
  std::feclearexcept(FE_ALL_EXCEPT);
  fmi2FreeInstance(c);
}

TEST(threads_and_resets_give_the_same_bits) {
  fmi2Component one = instantiate();
  CHECK(one != nullptr);
  const std::vector<double> expected = run(one, 50);
  CHECK(fmi2Reset(one) == fmi2OK);
  CHECK(run(one, 50) == expected);
  fmi2FreeInstance(one);
  std::vector<std::vector<double>> results(4);
  std::vector<std::thread> threads;
  for (auto& result : results)
    threads.emplace_back([&result] {
      fmi2Component c = instantiate();
      result = run(c, 50);
      fmi2FreeInstance(c);
    });
  for (auto& thread : threads) thread.join();
  for (const auto& result : results) CHECK(result == expected);
}

TEST(calls_in_the_wrong_state_or_on_dead_handles_are_errors) {
  CHECK(fmi2DoStep(nullptr, 0, 1, fmi2True) == fmi2Error);
  fmi2Component c = instantiate();
  CHECK(fmi2DoStep(c, 0, 0.01, fmi2True) == fmi2Error);
  CHECK(fmi2Reset(c) == fmi2OK);
  run(c, 1);
  fmi2FreeInstance(c);
  CHECK(fmi2DoStep(c, 0.01, 0.01, fmi2True) == fmi2Error);
  fmi2FreeInstance(c);
  CHECK(instantiate("{another}") == nullptr);
}

TEST(a_refused_value_changes_nothing) {
  fmi2Component c = instantiate();
  const fmi2ValueReference references[] = {26u << 24, 25u << 24};
  const double values[] = {5.0, -1.0};
  CHECK(fmi2SetReal(c, references, 2, values) == fmi2Error);
  CHECK(fmi2Reset(c) == fmi2OK);
  CHECK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0) == fmi2OK);
  CHECK(fmi2EnterInitializationMode(c) == fmi2OK);
  double stiffness = 0;
  CHECK(fmi2GetReal(c, references, 1, &stiffness) == fmi2OK);
  CHECK(stiffness == 1000.0);
  fmi2FreeInstance(c);
}

TEST(hundreds_of_instances_come_and_go) {
  for (int i = 0; i < 300; ++i) fmi2FreeInstance(instantiate());
}

namespace {

/// What a step is refused with; empty: it is not.
std::string refusal(const softffd::fmi::Times& times, double time, double step) {
  try {
    times.check_step(time, step);
  } catch (const softffd::fmi::CallError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST(a_step_goes_on_from_the_point_reached_to_rounding) {
  const softffd::fmi::Times times{.start = 100, .now = 103};
  for (double off : {0.0, 1e-9, -1e-9}) CHECK(refusal(times, 103 + off, 0.01).empty());
  for (double off : {1e-6, -1e-6, 0.01, double(NAN), double(INFINITY)})
    CHECK(refusal(times, 103 + off, 0.01).find("currentCommunicationPoint: wanted 103 s") == 0);
  CHECK(!refusal(times, 103 + 1e-9, 1e-8).empty());  // a tenth of the step
}

TEST(a_step_has_a_length_and_ends_within_the_run) {
  const softffd::fmi::Times times{.start = 0, .now = 0.9, .stop = 1};
  for (double step : {0.0, -0.1, double(NAN), double(INFINITY)})
    CHECK(refusal(times, 0.9, step).find("communicationStepSize: wanted > 0 s") == 0);
  CHECK(refusal(times, 0.9, 0.1).empty() && refusal(times, 0.9, 0.1 + 1e-10).empty());
  CHECK(refusal(times, 0.9, 0.1001) == "a step to 1.0001 s goes past the stop time 1 s");
}

TEST(the_horizon_is_the_length_of_the_run_or_the_one_expected) {
  CHECK((softffd::fmi::Times{.start = 2, .now = 2, .stop = 5}.horizon(7)) == 3);
  CHECK((softffd::fmi::Times{.start = 2, .now = 2}.horizon(7)) == 7);
}
