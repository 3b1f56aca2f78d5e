/// Wherever a request for memory fails, the call ends with fmi2Error (or no component), no crash and no leak.
#include <functional>

#include "counted_memory.hpp"

using namespace component;

namespace {

/// On a component that `prepare` made.
void every_request_may_fail(const char* what, const std::function<fmi2Component()>& prepare,
                            const std::function<fmi2Status(fmi2Component)>& call, fmi2Status otherwise = fmi2OK) {
  memory::survived(what, [&] {
    fmi2Component warm = prepare();
    call(warm);
    fmi2FreeInstance(warm);
    memory::each_request_fails(what, [&](auto&& failing) {
      fmi2Component c = prepare();
      const fmi2Status status = failing([&] { return call(c); });
      CHECK(status == (memory::failed ? fmi2Error : otherwise));
      if (memory::failed) CHECK(fmi2Reset(c) == fmi2OK && begin(c) == fmi2OK && step(c, 0) == fmi2OK);
      fmi2FreeInstance(c);
    });
    return true;
  });
}

}  // namespace

TEST(instantiation_survives_any_failing_request) {
  const std::string uri = resources(everything);
  for (const char* guid : {"{g}", "{another}"})
    memory::survived(guid, [&] {
      fmi2FreeInstance(instantiate(uri, fmi2True, guid));
      memory::each_request_fails(guid, [&](auto&& failing) {
        fmi2Component c = failing([&] { return instantiate(uri, fmi2True, guid); });
        CHECK(!memory::failed || !c);
        fmi2FreeInstance(c);
      });
      return true;
    });
}

TEST(initialization_survives_any_failing_request) {
  const std::string uri = resources(everything);
  const auto fresh = [&] { return instantiate(uri, fmi2True); };
  every_request_may_fail("setup", fresh, [](fmi2Component c) { return fmi2SetupExperiment(c, fmi2True, 1e-5, 0, fmi2True, 1); });
  every_request_may_fail("enter", fresh, fmi2EnterInitializationMode);
  const auto entered = [&] {
    fmi2Component c = instantiate(uri, fmi2True);
    fmi2EnterInitializationMode(c);
    return c;
  };
  every_request_may_fail("exit", entered, fmi2ExitInitializationMode);
}

TEST(values_survive_any_failing_request) {
  const std::string uri = resources(everything);
  const auto running = [&] { return started(uri, 3, fmi2True); };
  every_request_may_fail("set", running, [](fmi2Component c) { return set(c, Family::stiffness_edge, 0, 2000); });
  every_request_may_fail("get Integer", running, [](fmi2Component c) {
    const fmi2ValueReference contacts = reference(Family::plane_contacts);
    fmi2Integer number = 0;
    return fmi2GetInteger(c, &contacts, 1, &number);
  });
  every_request_may_fail("get Real", running, [](fmi2Component c) {
    for (Family family : {Family::position, Family::energy_kinetic, Family::energy_elastic, Family::solver_stable_step}) {
      const fmi2ValueReference wanted = reference(family);
      double number = 0;
      if (fmi2GetReal(c, &wanted, 1, &number) != fmi2OK) return fmi2Error;
    }
    return fmi2OK;
  });
  every_request_may_fail(
      "set Integer", [&] { return instantiate(uri, fmi2True); },
      [](fmi2Component c) {
        const fmi2ValueReference method = reference(Family::solver_method);
        const fmi2Integer number = 2;
        return fmi2SetInteger(c, &method, 1, &number);
      });
  every_request_may_fail("debug logging", running, [](fmi2Component c) {
    const fmi2String categories[] = {"logStatusWarning", "solver"};
    return fmi2SetDebugLogging(c, fmi2False, 2, categories);
  });
}

TEST(refusals_survive_any_failing_request) {
  const std::string uri = resources(everything);
  const auto refused = [&](const char* what, const std::function<fmi2Status(fmi2Component)>& call) {
    every_request_may_fail(what, [&] { return started(uri, 3, fmi2True); }, call, fmi2Error);
  };
  refused("a value below its bound", [](fmi2Component c) { return set(c, Family::stiffness_edge, 0, -1); });
  refused("a call in the wrong state", fmi2EnterInitializationMode);
  refused("a step at the wrong time", [](fmi2Component c) { return fmi2DoStep(c, 7, 0.01, fmi2True); });
  refused("a damaged state", [](fmi2Component c) {
    const fmi2Byte bytes[50] = {};
    fmi2FMUstate state = nullptr;
    return fmi2DeSerializeFMUstate(c, bytes, sizeof bytes, &state);
  });
}

TEST(steps_and_resets_survive_any_failing_request) {
  const std::string uri = resources(everything);
  for (int method : check::some<int>(2, {1, 2, 3, 8, 9})) {
    const auto running = [&] { return started(uri, method, fmi2True); };
    every_request_may_fail("step", running, [](fmi2Component c) { return step(c, 0); });
    every_request_may_fail(
        "step after a change",
        [&] {
          fmi2Component c = running();
          step(c, 0);
          set(c, Family::stiffness_edge, 0, 5000);
          return c;
        },
        [](fmi2Component c) { return step(c, 1); });
  }
  every_request_may_fail("reset", [&] { return started(uri, 3, fmi2True); }, fmi2Reset);
}

TEST(a_discarded_step_survives_any_failing_request) {
  const std::string uri = resources(everything);
  const auto too_stiff = [&] {
    fmi2Component c = started(uri, 3, fmi2True);
    set(c, Family::stiffness_edge, 0, 1e18);
    return c;
  };
  every_request_may_fail("discard", too_stiff, [](fmi2Component c) { return fmi2DoStep(c, 0, 1, fmi2True); }, fmi2Discard);
}

TEST(states_survive_any_failing_request) {
  const std::string uri = resources(everything);
  fmi2Component owner = started(uri, 3, fmi2True);
  CHECK(step(owner, 0) == fmi2OK);
  fmi2FMUstate kept = nullptr;
  CHECK(fmi2GetFMUstate(owner, &kept) == fmi2OK);
  std::size_t size = 0;
  CHECK(fmi2SerializedFMUstateSize(owner, kept, &size) == fmi2OK);
  std::vector<fmi2Byte> bytes(size);
  CHECK(fmi2SerializeFMUstate(owner, kept, bytes.data(), size) == fmi2OK);
  const auto running = [&] { return started(uri, 3, fmi2True); };
  every_request_may_fail("get state", running, [](fmi2Component c) {
    fmi2FMUstate state = nullptr;
    const fmi2Status status = fmi2GetFMUstate(c, &state);
    memory::fail_no_more();
    CHECK((status == fmi2OK) == (state != nullptr));
    fmi2FreeFMUstate(c, &state);
    return status;
  });
  every_request_may_fail("set state", running, [&](fmi2Component c) { return fmi2SetFMUstate(c, kept); });
  every_request_may_fail("serialize", running, [&](fmi2Component c) { return fmi2SerializeFMUstate(c, kept, bytes.data(), size); });
  every_request_may_fail("deserialize", running, [&](fmi2Component c) {
    fmi2FMUstate state = nullptr;
    const fmi2Status status = fmi2DeSerializeFMUstate(c, bytes.data(), size, &state);
    memory::fail_no_more();
    CHECK((status == fmi2OK) == (state != nullptr));
    fmi2FreeFMUstate(c, &state);
    return status;
  });
  CHECK(fmi2FreeFMUstate(owner, &kept) == fmi2OK);
  fmi2FreeInstance(owner);
}

TEST(a_state_that_failed_to_be_restored_leaves_the_instance_restorable) {
  fmi2Component c = started(resources(everything), 3);
  fmi2FMUstate kept = nullptr;
  CHECK(step(c, 0) == fmi2OK && fmi2GetFMUstate(c, &kept) == fmi2OK && step(c, 1) == fmi2OK);
  const std::vector<double> expected = positions(c);
  CHECK(fmi2SetFMUstate(c, kept) == fmi2OK);
  memory::each_request_fails("restore", [&](auto&& failing) {
    const fmi2Status status = failing([&] { return fmi2SetFMUstate(c, kept); });
    CHECK(status == (memory::failed ? fmi2Error : fmi2OK));
    if (memory::failed) CHECK(fmi2SetFMUstate(c, kept) == fmi2OK);
    CHECK(step(c, 1) == fmi2OK && positions(c) == expected);
  });
  CHECK(fmi2FreeFMUstate(c, &kept) == fmi2OK);
  fmi2FreeInstance(c);
}
