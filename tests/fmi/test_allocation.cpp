/// Memory: fmi2DoStep asks for none, and wherever a request fails the call ends with fmi2Error (or no
/// component), no crash and no leak.
///
/// With glibc the program's own malloc stands in front of the C library's, so every request is seen: operator
/// new, Eigen's buffers, the C library's own. Sanitizers bring a malloc of their own; there operator new
/// alone is seen.
#include <cstdlib>
#include <cstring>
#include <functional>
#include <new>
#include <string>
#include <vector>

extern "C" {
#include "fmi2Functions.h"
}

#include "check.hpp"
#include "small_scene.hpp"
#include "variable_table.hpp"

#if defined(__unix__)
#include <sys/wait.h>
#include <unistd.h>
#endif

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED 1
#endif
#endif

using softffd::fmi::Family;

namespace memory {

long requests = 0;    ///< so far
long live = 0;        ///< blocks that are not freed
long countdown = -1;  ///< the request that fails, counted from 0; negative: none does
bool failed = false;  ///< a request has failed since `fail_at`

bool granted() {
  ++requests;
  if (countdown < 0 || countdown-- > 0) return true;
  failed = true;
  countdown = 0;  // so do all that follow
  return false;
}

template <class Request>
void* counted(Request&& request) {
  void* block = granted() ? request() : nullptr;
  live += block != nullptr;
  return block;
}

void fail_at(long request) {
  failed = false;
  countdown = request;
}
void fail_no_more() { countdown = -1; }

}  // namespace memory

#if defined(__GLIBC__) && !defined(SANITIZED)
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  return memory::counted([&] { return __libc_malloc(size); });
}
void* calloc(std::size_t count, std::size_t size) {
  return memory::counted([&] { return __libc_calloc(count, size); });
}
void* memalign(std::size_t alignment, std::size_t size) {
  return memory::counted([&] { return __libc_memalign(alignment, size); });
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = memalign(alignment, size);
  return *block ? 0 : 12;
}
void* realloc(void* block, std::size_t size) {
  if (!block) return malloc(size);
  return memory::granted() ? __libc_realloc(block, size) : nullptr;
}
void free(void* block) {
  memory::live -= block != nullptr;
  __libc_free(block);
}
}
#else
#define KEPT_WHOLE __attribute__((noinline))  // inlined, the pairs look mismatched to the compiler
KEPT_WHOLE void* operator new(std::size_t size) {
  void* block = memory::counted([&] { return std::malloc(size ? size : 1); });
  if (!block) throw std::bad_alloc();
  return block;
}
KEPT_WHOLE void* operator new[](std::size_t size) { return operator new(size); }
KEPT_WHOLE void operator delete(void* block) noexcept {
  memory::live -= block != nullptr;
  std::free(block);
}
KEPT_WHOLE void operator delete(void* block, std::size_t) noexcept { operator delete(block); }
KEPT_WHOLE void operator delete[](void* block) noexcept { operator delete(block); }
KEPT_WHOLE void operator delete[](void* block, std::size_t) noexcept { operator delete(block); }
#endif

namespace {

/// Writes a scene and returns the URI of its folder.
std::string resources(const std::string& parts, bool stiff = false, const std::string& spin = "0 0 0") {
  return (stiff ? small_scene::Box{.stiffness = 1e8, .initial = "1 1 1 0 0 0.001 0 0 0 " + spin} : small_scene::Box{}).resources(parts);
}

const std::string damped = "damping 0.05\n", heavy = "gravity 0 0 -9.81\n", watched = "energy\nsolver\nreactions\n";
const std::string planes = "plane ground fixed 0 0 0 0.1 0 1 0 0 0 0 0 0 0.4\nplane wall input 1.02 0 0 -1 0 0 0 0 0 0 0.1 0 0.2\n";
const std::string corner = "plane side fixed 0 -0.01 0 0 1 0 0 0 0 0 0 0 0.3\n";
const std::string pins = "pin base fixed 0 1\npin hand input 26\n";
const std::string driven = "load push 18 19 20\nforces 13 14\n";
const std::string regions = "region_stiffness 4000 0 1 2\nregion_damping 0.2 3 4\nprobe tip 0.5 0.5 0.9\nvelocities 0 13\n";
const std::string everything = damped + heavy + planes + pins + driven + regions + watched;

fmi2ValueReference reference(Family family, unsigned index = 0) { return unsigned(family) << 24 | index; }

void silent(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...) {}

fmi2Component instantiate(const std::string& uri, fmi2Boolean logging = fmi2False, const char* guid = "{g}") {
  const fmi2CallbackFunctions callbacks{silent, std::calloc, std::free, nullptr, nullptr};
  return fmi2Instantiate("box", fmi2CoSimulation, guid, uri.c_str(), &callbacks, fmi2False, logging);
}

fmi2Component started(const std::string& uri, int method = 1, fmi2Boolean logging = fmi2False) {
  fmi2Component c = instantiate(uri, logging);
  const fmi2ValueReference solver = reference(Family::solver_method);
  CHECK(fmi2SetInteger(c, &solver, 1, &method) == fmi2OK);
  CHECK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0) == fmi2OK);
  CHECK(fmi2EnterInitializationMode(c) == fmi2OK);
  CHECK(fmi2ExitInitializationMode(c) == fmi2OK);
  return c;
}

fmi2Status set(fmi2Component c, Family family, unsigned index, double value) {
  const fmi2ValueReference wanted = reference(family, index);
  return fmi2SetReal(c, &wanted, 1, &value);
}

/// Runs a block in a process of its own, so that a crash is a failed check and not the end of the program.
void survived(const char* what, const std::function<void()>& block) {
#if defined(__unix__)
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    const int before = check::failures;
    block();
    std::fflush(nullptr);
    _exit(check::failures > before);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) std::printf("    %s: ended by signal %d\n", what, WTERMSIG(status));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) check::report(__FILE__, __LINE__, what);
#else
  block();
#endif
}

/// True once a scenario has said enough.
bool enough_failures(int before) { return check::failures > before + 20; }

/// Lets the first, second, ... request of `call` fail, each on a component that `prepare` made, until the
/// call needs no more.
void every_request_may_fail(const char* what, const std::function<fmi2Component()>& prepare,
                            const std::function<fmi2Status(fmi2Component)>& call) {
  survived(what, [&] {
    fmi2Component warm = prepare();
    call(warm);
    fmi2FreeInstance(warm);
    const int failures = check::failures;
    for (long request = 0;; ++request) {
      const long before = memory::live;
      fmi2Component c = prepare();
      memory::fail_at(request);
      const fmi2Status status = call(c);
      memory::fail_no_more();
      if (memory::failed) {
        CHECK(status == fmi2Error);
        CHECK(fmi2Reset(c) == fmi2OK);
        CHECK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0) == fmi2OK);
        CHECK(fmi2EnterInitializationMode(c) == fmi2OK);
        CHECK(fmi2ExitInitializationMode(c) == fmi2OK);
        CHECK(fmi2DoStep(c, 0, 0.01, fmi2True) == fmi2OK);
      }
      fmi2FreeInstance(c);
      if (memory::live != before) std::printf("    %s: request %ld leaves %ld blocks\n", what, request, memory::live - before);
      CHECK(memory::live == before);
      if (!memory::failed || enough_failures(failures)) break;
    }
  });
}

struct Case {
  const char* name;
  std::string parts;
  bool stiff = false;  ///< and not vibrating; for the methods that take implicit steps
  std::string spin = "0 0 0";
};

const std::vector<Case>& cases() {
  static const std::vector<Case> list{{"bare", ""},
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
                                      {"stiff, in contact", damped + heavy + planes + watched + "error_estimate\n", true},
                                      {"volume stiffness", damped + heavy + planes + "volume_stiffness 1e4\n"},
                                      {"everything", everything}};
  return list;
}

/// Requests of 30 steps with inputs that change and are ramped; the first steps, which choose and log the
/// solver, apart.
void count_step_requests(const Case& scene, int method, bool ramped, long& first, long& later) {
  const std::string uri = resources(scene.parts, scene.stiff, scene.spin);
  fmi2Component c = started(uri, method);
  const bool has_load = scene.parts.find("load") != std::string::npos, has_plane = scene.parts.find("wall") != std::string::npos;
  const fmi2ValueReference load = reference(Family::load), wall = reference(Family::plane_velocity);
  const fmi2Integer order = 1;
  first = later = 0;
  for (int n = 0; n < 30; ++n) {
    const double rate = 0.3 * n;
    if (has_load) set(c, Family::load, 1, 2.0 * n);
    if (has_plane) set(c, Family::plane_velocity, 0, -0.001 * n);
    if (has_load && ramped) CHECK(fmi2SetRealInputDerivatives(c, &load, 1, &order, &rate) == fmi2OK);
    if (has_plane && ramped) CHECK(fmi2SetRealInputDerivatives(c, &wall, 1, &order, &rate) == fmi2OK);
    const long before = memory::requests;
    const fmi2Status status = fmi2DoStep(c, 0.01 * n, 0.01, fmi2True);
    (n == 0 ? first : later) += memory::requests - before;
    CHECK(status == fmi2OK);
  }
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

TEST(steps_ask_for_no_memory) {
  for (const Case& scene : cases())
    for (int method = 1; method <= softffd::fmi::method_count; ++method)
      for (bool ramped : {false, true}) {
        if (scene.stiff && method != 1 && method != softffd::fmi::method_count) continue;
        long first = 0, later = 0;
        count_step_requests(scene, method, ramped, first, later);
        if (first + later > 0)
          std::printf("    %s, method %d%s: %ld requests in the first step, %ld in 29 more\n", scene.name, method, ramped ? ", ramped" : "",
                      first, later);
        CHECK(first == 0);
        CHECK(later == 0);
      }
}

TEST(a_step_after_a_changed_parameter_asks_for_no_memory) {
  for (int method = 1; method <= softffd::fmi::method_count; ++method) {
    fmi2Component c = started(resources(everything), method);
    long requests = 0;
    for (int n = 0; n < 10; ++n) {
      CHECK(set(c, Family::stiffness_edge, 0, 1000.0 + n) == fmi2OK);
      CHECK(set(c, Family::damping, 0, 0.05 + 0.01 * n) == fmi2OK);
      CHECK(set(c, Family::gravity, 2, -9.0) == fmi2OK);
      const long before = memory::requests;
      CHECK(fmi2DoStep(c, 0.01 * n, 0.01, fmi2True) == fmi2OK);
      if (n > 0) requests += memory::requests - before;
    }
    if (requests > 0) std::printf("    method %d: %ld requests in 9 steps\n", method, requests);
    CHECK(requests == 0);
    fmi2FreeInstance(c);
  }
}

TEST(instantiation_survives_any_failing_request) {
  const std::string uri = resources(everything);
  for (const char* guid : {"{g}", "{another}"})
    survived(guid, [&] {
      fmi2FreeInstance(instantiate(uri, fmi2True, guid));
      const int failures = check::failures;
      for (long request = 0;; ++request) {
        const long before = memory::live;
        memory::fail_at(request);
        fmi2Component c = instantiate(uri, fmi2True, guid);
        memory::fail_no_more();
        CHECK(!memory::failed || !c);
        fmi2FreeInstance(c);
        if (memory::live != before) std::printf("    request %ld leaves %ld blocks\n", request, memory::live - before);
        CHECK(memory::live == before);
        if (!memory::failed || enough_failures(failures)) break;
      }
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
  const auto running = [&] { return started(uri, 3, fmi2True); };
  every_request_may_fail("a value below its bound", running, [](fmi2Component c) { return set(c, Family::stiffness_edge, 0, -1); });
  every_request_may_fail("a call in the wrong state", running, fmi2EnterInitializationMode);
  every_request_may_fail("a step at the wrong time", running, [](fmi2Component c) { return fmi2DoStep(c, 7, 0.01, fmi2True); });
  every_request_may_fail("a damaged state", running, [](fmi2Component c) {
    const fmi2Byte bytes[50] = {};
    fmi2FMUstate state = nullptr;
    return fmi2DeSerializeFMUstate(c, bytes, sizeof bytes, &state);
  });
}

TEST(steps_and_resets_survive_any_failing_request) {
  const std::string uri = resources(everything);
  for (int method : {2, 3}) {
    const auto running = [&] { return started(uri, method, fmi2True); };
    every_request_may_fail("step", running, [](fmi2Component c) { return fmi2DoStep(c, 0, 0.01, fmi2True); });
    every_request_may_fail(
        "step after a change",
        [&] {
          fmi2Component c = running();
          fmi2DoStep(c, 0, 0.01, fmi2True);
          set(c, Family::stiffness_edge, 0, 5000);
          return c;
        },
        [](fmi2Component c) { return fmi2DoStep(c, 0.01, 0.01, fmi2True); });
  }
  every_request_may_fail("reset", [&] { return started(uri, 3, fmi2True); }, fmi2Reset);
}

TEST(a_discarded_step_survives_any_failing_request) {
  const std::string uri = resources(everything);
  survived("discard", [&] {
    const int failures = check::failures;
    for (long request = 0;; ++request) {
      const long before = memory::live;
      fmi2Component c = started(uri, 3, fmi2True);
      set(c, Family::stiffness_edge, 0, 1e18);
      memory::fail_at(request);
      const fmi2Status status = fmi2DoStep(c, 0, 1, fmi2True);
      memory::fail_no_more();
      CHECK(status == (memory::failed ? fmi2Error : fmi2Discard));
      fmi2FreeInstance(c);
      if (request > 0) CHECK(memory::live == before);
      if (!memory::failed || enough_failures(failures)) break;
    }
  });
}

TEST(states_survive_any_failing_request) {
  const std::string uri = resources(everything);
  fmi2Component owner = started(uri, 3, fmi2True);
  CHECK(fmi2DoStep(owner, 0, 0.01, fmi2True) == fmi2OK);
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
  const std::string uri = resources(everything);
  fmi2Component c = started(uri, 3);
  fmi2FMUstate kept = nullptr;
  CHECK(fmi2DoStep(c, 0, 0.01, fmi2True) == fmi2OK);
  CHECK(fmi2GetFMUstate(c, &kept) == fmi2OK);
  const fmi2ValueReference wanted = reference(Family::position, 40);
  double expected = 0, got = 0;
  CHECK(fmi2DoStep(c, 0.01, 0.01, fmi2True) == fmi2OK);
  CHECK(fmi2GetReal(c, &wanted, 1, &expected) == fmi2OK);
  const int failures = check::failures;
  for (long request = 0; !enough_failures(failures); ++request) {
    memory::fail_at(request);
    const fmi2Status status = fmi2SetFMUstate(c, kept);
    memory::fail_no_more();
    CHECK(status == (memory::failed ? fmi2Error : fmi2OK));
    if (memory::failed) CHECK(fmi2SetFMUstate(c, kept) == fmi2OK);
    CHECK(fmi2DoStep(c, 0.01, 0.01, fmi2True) == fmi2OK);
    CHECK(fmi2GetReal(c, &wanted, 1, &got) == fmi2OK);
    CHECK(std::memcmp(&got, &expected, sizeof got) == 0);
    if (!memory::failed) break;
  }
  CHECK(fmi2FreeFMUstate(c, &kept) == fmi2OK);
  fmi2FreeInstance(c);
}
