/// fmi2DoStep asks for memory where something is used for the first time, and for no more.
#include <vector>

#include "counted_memory.hpp"

using namespace component;

namespace {

struct Case {
  const char* name;
  std::string parts;
  bool stiff = false;  ///< and not vibrating; for the methods that take implicit steps
  std::string spin = "0 0 0";
  long modes = 0;  ///< requests at most in the first step, where the modes of a material are made at the first flight beside an obstacle
};

const std::string modulus = "youngs_modulus 3e3\nregion_youngs_modulus 6e3 0 1 3 4 9 10 12 13\n";

const std::vector<Case>& cases() {
  static const std::vector<Case> list{
      {"bare", ""},
      {"damped", damped},
      {"planes", heavy + planes},
      {"three planes on a point", heavy + planes + corner},
      {"pins", pins},
      {"planes and pins", "plane ceiling input 0 0 1.2 0 0 -1 0 0 0 0 0 0 0.1\n" + pins},
      {"inputs", driven},
      {"energy", damped + heavy + watched},
      {"energy and planes", damped + heavy + planes + watched},
      {"an error estimate", damped + heavy + planes + "error_estimate\n"},
      {"stiff", damped + driven, true},
      {"stiff, turning", damped + driven + watched, true, "3 4 -2"},
      {"stiff, turning, alone", "error_estimate\n", true, "3 4 -2"},
      {"stiff, with an error estimate", damped + driven + "error_estimate\n", true},
      {"stiff, in contact", damped + heavy + planes + watched + "error_estimate\n", true, "0 0 0", 60},
      {"volume stiffness", damped + heavy + planes + "volume_stiffness 1e4\n"},
      {"a modulus", heavy + planes + modulus},
      {"internal damping", heavy + planes + pins + "internal_damping 1e-4\n"},
      {"stiff, internal damping", damped + driven + "internal_damping 1e-4\n", true},
      {"everything", everything},
  };
  return list;
}

/// Takes steps twice, from the same state: the second time all that they use is there.
template <class Steps>
void take_twice(fmi2Component c, Steps&& steps) {
  fmi2FMUstate begun = nullptr;
  CHECK(fmi2GetFMUstate(c, &begun) == fmi2OK);
  steps();
  CHECK(fmi2SetFMUstate(c, begun) == fmi2OK && fmi2FreeFMUstate(c, &begun) == fmi2OK);
  steps();
}

const int steps = check::thorough ? 10 : 5;

/// Requests of some steps with inputs that change and are ramped; the first steps, which choose and log the
/// solver, apart. All of them have been taken before.
void count_step_requests(const Case& scene, int method, bool ramped, long& first, long& later) {
  const bool resolves =
      method == int(softffd::fmi::MethodValue::sdirk2);  // takes thousands of internal steps where it keeps the usual tolerance
  const std::string uri = resources(scene.parts + (resolves ? "tolerance 1e-2\n" : ""), scene.stiff, scene.spin);
  fmi2Component c = started(uri, method);
  const bool has_load = scene.parts.find("load") != std::string::npos, has_plane = scene.parts.find("wall") != std::string::npos;
  const fmi2ValueReference load = reference(Family::load), wall = reference(Family::plane_velocity);
  const fmi2Integer order = 1;
  take_twice(c, [&] {
    first = later = 0;
    for (int n = 0; n < steps; ++n) {
      const double rate = 0.6 * n;
      if (has_load) set(c, Family::load, 1, 4.0 * n);
      if (has_plane) set(c, Family::plane_velocity, 0, -0.002 * n);
      if (has_load && ramped) CHECK(fmi2SetRealInputDerivatives(c, &load, 1, &order, &rate) == fmi2OK);
      if (has_plane && ramped) CHECK(fmi2SetRealInputDerivatives(c, &wall, 1, &order, &rate) == fmi2OK);
      const long before = memory::requests;
      const fmi2Status status = step(c, n);
      (n == 0 ? first : later) += memory::requests - before;
      CHECK(status == fmi2OK);
    }
  });
  fmi2FreeInstance(c);
}

}  // namespace

TEST(the_hook_sees_requests) {
  const long before = memory::requests;
  delete new volatile int(1);
  CHECK(memory::requests > before);
#if defined(__GLIBC__) && !defined(SANITIZED)
  const long plain = memory::requests;
  void* volatile block = std::malloc(8);
  std::free(block);
  CHECK(memory::requests == plain + 1);
#endif
}

TEST(steps_ask_for_no_memory_once_all_they_use_is_there) {
  int of_all = 0;
  for (const Case& scene : cases())
    for (int method = 1; method <= softffd::fmi::method_count; ++method)
      for (bool ramped : {false, true}) {
        if (scene.stiff && method != 1 && method < 8) continue;
        const bool moved = scene.parts.find("load") != std::string::npos || scene.parts.find("wall") != std::string::npos;
        if (ramped && !moved) continue;  // the same run again
        if (!check::thorough && scene.parts != everything && ++of_all % 3 > 0) continue;
        long first = 0, later = 0;
        count_step_requests(scene, method, ramped, first, later);
        if (first + later > 0)
          std::printf("    %s, method %d%s: %ld requests in the first step, %ld in the others\n", scene.name, method,
                      ramped ? ", ramped" : "", first, later);
        CHECK(first <= scene.modes);
        CHECK(later == 0);
      }
}

TEST(getters_ask_for_no_memory) {
  fmi2Component c = started(resources(everything));
  CHECK(step(c, 0) == fmi2OK);
  const fmi2ValueReference integers[] = {reference(Family::plane_contacts), reference(Family::solver_steps),
                                         reference(Family::solver_method)};
  const fmi2ValueReference reals[] = {reference(Family::position), reference(Family::energy_elastic), reference(Family::plane_reaction),
                                      reference(Family::solver_stable_step)};
  const fmi2Integer orders[] = {1, 1, 1};
  fmi2Integer counts[3];
  double numbers[4], time = 0;
  const long before = memory::requests;
  CHECK(fmi2GetInteger(c, integers, 3, counts) == fmi2OK);
  CHECK(fmi2GetReal(c, reals, 4, numbers) == fmi2OK);
  CHECK(fmi2GetRealOutputDerivatives(c, reals, 3, orders, numbers) == fmi2OK);
  CHECK(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &time) == fmi2OK);
  CHECK(memory::requests == before);
  CHECK(counts[1] > 0 && time == 0.01);
  fmi2FreeInstance(c);
}

TEST(a_step_after_a_changed_parameter_asks_for_no_memory) {
  for (int method = 0; method <= softffd::fmi::method_count; ++method) {
    const bool of_modulus = method == 0;
    fmi2Component c = of_modulus ? started(resources(heavy + planes + modulus)) : started(resources(everything), method);
    long requests = 0;
    take_twice(c, [&] {
      requests = 0;
      for (int n = 0; n < 10; ++n) {
        CHECK(set(c, of_modulus ? Family::youngs_modulus : Family::stiffness_edge, 0, (of_modulus ? 3000.0 : 1000.0) + n) == fmi2OK);
        if (!of_modulus) CHECK(set(c, Family::damping, 0, 0.05 + 0.01 * n) == fmi2OK && set(c, Family::gravity, 2, -9.0) == fmi2OK);
        const long before = memory::requests;
        CHECK(step(c, n) == fmi2OK);
        if (n > 0) requests += memory::requests - before;
      }
    });
    if (requests > 0) std::printf("    method %d: %ld requests in 9 steps\n", method, requests);
    CHECK(requests == 0);
    fmi2FreeInstance(c);
  }
}
