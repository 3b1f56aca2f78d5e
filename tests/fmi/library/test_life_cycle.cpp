/// The C interface driven as a host drives it; meant for sanitizers above all.
#include <cfenv>
#include <cmath>

#include "host.hpp"
#include "instances.hpp"
#include "life_cycle.hpp"

TEST(floating_point_exceptions_are_the_hosts_own) {
  fmi2Component c = component::instantiate(component::resources(component::everything));
  std::feclearexcept(FE_ALL_EXCEPT);
  CHECK(component::begin(c) == fmi2OK && component::step(c, 0) == fmi2OK && component::step(c, 1) == fmi2OK);
  CHECK(std::fetestexcept(FE_ALL_EXCEPT) == 0);
  std::feraiseexcept(FE_DIVBYZERO);
  CHECK(component::step(c, 2) == fmi2OK);
  CHECK(std::fetestexcept(FE_ALL_EXCEPT) == FE_DIVBYZERO);
  std::feclearexcept(FE_ALL_EXCEPT);
  fmi2FreeInstance(c);
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

TEST(a_step_that_does_not_advance_time_is_refused_with_the_smallest_one) {
  const std::string wanted = "communicationStepSize: wanted at least 0.125 s at time 1e+15 s, where a shorter step does not advance time";
  for (const softffd::fmi::Times times : {softffd::fmi::Times{.start = 1e15, .now = 1e15}, {.start = 0, .now = 1e15}})
    CHECK(refused_step(times, 1e15, 0.01) == wanted + ", got 0.01" && refused_step(times, 1e15, 0.125).empty());
  CHECK(!refused_step({.start = -4, .now = 0}, 0, 1e-20).empty());  // the body's clock is at 4 s
  CHECK(refused_step({}, 0, 1e-290).empty());
  for (const double step : {1e-300, 1e-308, 5e-324})  // rates over them overflow
    CHECK(refused_step({}, 0, step).find("communicationStepSize: wanted at least 1e-290 s at time 0 s") == 0);
}

TEST(the_horizon_is_the_length_of_the_run_or_the_one_expected) {
  CHECK((softffd::fmi::Times{.start = 2, .now = 2, .stop = 5}.horizon(7)) == 3);
  CHECK((softffd::fmi::Times{.start = 2, .now = 2}.horizon(7)) == 7);
}
