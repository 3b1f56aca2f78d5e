/// The library as a file, loaded as an importer loads it: it exports what is asked for and computes what the same sources linked here do.
#include "host.hpp"

#ifdef _WIN32
#include <windows.h>  // last: it makes macros of words
#else
#include <dlfcn.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

using Function = void (*)();

#ifdef _WIN32
HMODULE library() { return LoadLibraryA(SOFTFFD_LIBRARY); }
Function find(HMODULE library, const char* name) { return reinterpret_cast<Function>(GetProcAddress(library, name)); }
#else
void* library() { return dlopen(SOFTFFD_LIBRARY, RTLD_NOW | RTLD_LOCAL); }
Function find(void* library, const char* name) { return reinterpret_cast<Function>(dlsym(library, name)); }
#endif

struct Calls {
  fmi2InstantiateTYPE* instantiate;
  fmi2SetupExperimentTYPE* setup_experiment;
  fmi2EnterInitializationModeTYPE* enter;
  fmi2ExitInitializationModeTYPE* exit;
  fmi2DoStepTYPE* do_step;
  fmi2GetRealTYPE* get_real;
  fmi2FreeInstanceTYPE* free_instance;
};

/// Positions after a fall onto the ground.
std::vector<double> run(const Calls& call, const std::string& resources) {
  fmi2Component c = call.instantiate("box", fmi2CoSimulation, "{g}", resources.c_str(), &component::quiet_callbacks, fmi2False, fmi2False);
  CHECK(c != nullptr);
  CHECK(call.setup_experiment(c, fmi2False, 0, 0, fmi2False, 0) == fmi2OK);
  CHECK(call.enter(c) == fmi2OK && call.exit(c) == fmi2OK);
  for (int i = 0; i < 30; ++i) CHECK(call.do_step(c, i * 0.01, 0.01, fmi2True) == fmi2OK);
  std::vector<fmi2ValueReference> references(81);
  for (unsigned i = 0; i < 81; ++i) references[i] = component::reference(component::Family::position, i);
  std::vector<double> positions(81);
  CHECK(call.get_real(c, references.data(), 81, positions.data()) == fmi2OK);
  call.free_instance(c);
  return positions;
}

}  // namespace

#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
TEST(unloading_leaves_no_memory_behind) {
  size_t before = 0;
  for (int i = 0; i < 10; ++i) {
    void* handle = library();
    CHECK(handle != nullptr && dlclose(handle) == 0);
    CHECK(dlopen(SOFTFFD_LIBRARY, RTLD_NOW | RTLD_NOLOAD) == nullptr);
    if (i == 0) before = mallinfo2().uordblks;
  }
  CHECK(mallinfo2().uordblks < before + 70'000);  // what the C++ runtime allocates in one load; the loader itself keeps some kB
}
#endif

TEST(the_library_file_runs_to_the_same_bits) {
  const auto handle = library();
  CHECK(handle != nullptr);
  if (!handle) return;
  const auto take = [&](auto*& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(find(handle, name));
    CHECK(function != nullptr);
    return function != nullptr;
  };
  Calls loaded{};
  if (!(take(loaded.instantiate, "fmi2Instantiate") && take(loaded.setup_experiment, "fmi2SetupExperiment") &&
        take(loaded.enter, "fmi2EnterInitializationMode") && take(loaded.exit, "fmi2ExitInitializationMode") &&
        take(loaded.do_step, "fmi2DoStep") && take(loaded.get_real, "fmi2GetReal") && take(loaded.free_instance, "fmi2FreeInstance")))
    return;
  const Calls linked{fmi2Instantiate, fmi2SetupExperiment, fmi2EnterInitializationMode, fmi2ExitInitializationMode, fmi2DoStep,
                     fmi2GetReal,     fmi2FreeInstance};
  const std::string resources =
      small_scene::Box{}.resources("damping 0.01\ngravity 0 0 -9.81\nplane ground fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.4\n");
  CHECK(run(loaded, resources) == run(linked, resources));
}
