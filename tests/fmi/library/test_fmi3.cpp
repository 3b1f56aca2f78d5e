/// The functions of FMI 3.0 driven as a host drives them; meant for sanitizers and for memory that runs out above all.
#include <string>
#include <vector>

extern "C" {
#include "fmi3Functions.h"
}

#include "counted_memory.hpp"
#include "resource/resource_uri.hpp"

using namespace component;

namespace {

constexpr unsigned points = 27;

const std::string& folder() {
  static const std::string path = softffd::fmi::path_from_uri(resources(everything)) + "/";
  return path;
}

void quiet(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String) {}

fmi3Instance opened(const char* token = "{g}") {
  return fmi3InstantiateCoSimulation("box", token, folder().c_str(), false, true, false, false, nullptr, 0, nullptr, quiet, nullptr);
}

fmi3Status entered(fmi3Instance c) { return fmi3EnterInitializationMode(c, true, 1e-4, 0, true, 1); }

fmi3Instance running() {
  fmi3Instance c = opened();
  CHECK(entered(c) == fmi3OK);
  CHECK(fmi3ExitInitializationMode(c) == fmi3OK);
  return c;
}

fmi3Status step_of(fmi3Instance c, int n) {
  fmi3Boolean event = true, end = true, early = true;
  fmi3Float64 time = -1;
  const fmi3Status status = fmi3DoStep(c, n * 0.01, 0.01, true, &event, &end, &early, &time);
  CHECK(status != fmi3OK || (!event && !end && !early && time > n * 0.01));
  return status;
}

fmi3Status get(fmi3Instance c, Family family, std::vector<double>& values) {
  const fmi3ValueReference wanted = reference(family);
  return fmi3GetFloat64(c, &wanted, 1, values.data(), values.size());
}

fmi3Status push(fmi3Instance c, double force) {
  const fmi3ValueReference wanted[] = {reference(Family::load), reference(Family::stiffness_edge)};
  const double values[] = {0, force, 0, 900};
  return fmi3SetFloat64(c, wanted, 2, values, 4);
}

std::vector<double> run(fmi3Instance c) {
  for (int n = 0; n < 20; ++n) {
    CHECK(push(c, 0.1 * n) == fmi3OK);
    CHECK(step_of(c, n) == fmi3OK);
  }
  std::vector<double> positions(3 * points);
  CHECK(get(c, Family::position, positions) == fmi3OK);
  return positions;
}

fmi3Status saved(fmi3Instance c) {
  fmi3FMUState state = nullptr;
  fmi3Status status = fmi3GetFMUState(c, &state);
  if (status != fmi3OK) return status;
  std::size_t size = 0;
  CHECK(fmi3SerializedFMUStateSize(c, state, &size) == fmi3OK);
  std::vector<fmi3Byte> bytes(size);
  fmi3FMUState again = nullptr;
  CHECK(fmi3SerializeFMUState(c, state, bytes.data(), size) == fmi3OK);
  CHECK(fmi3DeserializeFMUState(c, bytes.data(), size, &again) == fmi3OK);
  CHECK(fmi3SetFMUState(c, again) == fmi3OK);
  CHECK(fmi3FreeFMUState(c, &again) == fmi3OK && !again);
  return fmi3FreeFMUState(c, &state);
}

/// Each on a new instance.
template <class Prepare, class Call>
void every_request_may_fail(Prepare&& prepare, Call&& call) {
  memory::each_request_fails("a call", [&](auto&& failing) {
    fmi3Instance c = prepare();
    const fmi3Status status = failing([&] { return call(c); });
    CHECK(status == (memory::failed ? fmi3Error : fmi3OK));
    CHECK(fmi3Reset(c) == fmi3OK);
    fmi3FreeInstance(c);
  });
}

}  // namespace

TEST(resets_and_states_give_the_same_bits) {
  fmi3Instance one = running();
  const std::vector<double> expected = run(one);
  CHECK(fmi3Reset(one) == fmi3OK && entered(one) == fmi3OK && fmi3ExitInitializationMode(one) == fmi3OK && saved(one) == fmi3OK);
  CHECK(run(one) == expected);
  fmi3FreeInstance(one);
}

TEST(a_handle_of_one_standard_is_none_of_the_other) {
  fmi3Instance three = opened();
  fmi2Component two = instantiate(resources(everything));
  CHECK(fmi2Reset(three) == fmi2Error && fmi3Reset(two) == fmi3Error);
  fmi2FreeInstance(three);
  fmi3FreeInstance(two);
  CHECK(fmi3Reset(three) == fmi3OK && fmi2Reset(two) == fmi2OK);
  fmi3FreeInstance(three);
  fmi2FreeInstance(two);
  CHECK(opened("{another}") == nullptr);
}

TEST(every_call_survives_any_failing_request) {
  fmi3FreeInstance(opened());  // what is asked for once
  const auto fresh = [] { return opened(); };
  every_request_may_fail(fresh, entered);
  every_request_may_fail(running, [](fmi3Instance c) { return push(c, 1.0); });
  every_request_may_fail(running, [](fmi3Instance c) {
    double positions[3 * points];
    const fmi3ValueReference wanted = reference(Family::position);
    return fmi3GetFloat64(c, &wanted, 1, positions, 3 * points);
  });
  every_request_may_fail(running, [](fmi3Instance c) {
    fmi3Int64 steps = 0;
    const fmi3ValueReference wanted = reference(Family::solver_steps);
    return fmi3GetInt64(c, &wanted, 1, &steps, 1);
  });
  every_request_may_fail(running, [](fmi3Instance c) {
    double slopes[3 * points];
    const fmi3Int32 first = 1;
    const fmi3ValueReference wanted = reference(Family::position);
    return fmi3GetOutputDerivatives(c, &wanted, 1, &first, slopes, 3 * points);
  });
  for (const char* token : {"{g}", "{another}"})
    memory::each_request_fails(token, [&](auto&& failing) {
      fmi3Instance c = failing([&] { return opened(token); });
      CHECK(!memory::failed || !c);
      fmi3FreeInstance(c);
    });
}
