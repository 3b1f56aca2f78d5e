/// The library as an importer loads it, on threads that have met no exception yet: where any request for memory fails, its calls end as
/// they do elsewhere (test_failing_memory.cpp), and never the process.
#include "counted_memory.hpp"

#if defined(__GLIBC__) && !defined(SANITIZED)
#include <dlfcn.h>

#include <atomic>
#include <optional>
#include <thread>

using namespace component;

namespace {

template <class Call>
Call* from(void* library, const char* name) {
  return reinterpret_cast<Call*>(dlsym(library, name));
}

struct Loaded {
  void* library = dlopen(SOFTFFD_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  fmi2InstantiateTYPE* instantiate = from<fmi2InstantiateTYPE>(library, "fmi2Instantiate");
  fmi2DoStepTYPE* do_step = from<fmi2DoStepTYPE>(library, "fmi2DoStep");
  fmi2GetFMUstateTYPE* get_state = from<fmi2GetFMUstateTYPE>(library, "fmi2GetFMUstate");
  fmi2ResetTYPE* reset = from<fmi2ResetTYPE>(library, "fmi2Reset");
  fmi2FreeInstanceTYPE* free_instance = from<fmi2FreeInstanceTYPE>(library, "fmi2FreeInstance");

  fmi2Component instance(const std::string& uri) const {
    return instantiate("box", fmi2CoSimulation, "{g}", uri.c_str(), &quiet_callbacks, fmi2False, fmi2True);
  }
};

/// A thread that does one thing, when it is told to.
class Worker {
 public:
  void run(const std::function<void()>& work) {
    work_ = &work;
    given_ = true;
    thread_.join();
  }

 private:
  const std::function<void()>* work_ = nullptr;
  std::atomic<bool> given_ = false;
  std::thread thread_{[this] {
    while (!given_) std::this_thread::yield();
    (*work_)();
  }};
};

/// What a block returns in a process of its own. early: the thread is there before the library is loaded.
bool survived(bool early, const std::function<bool(const Loaded&, Worker&)>& block) {
  return memory::survived("a thread", [&] {
    std::optional<Worker> worker;
    if (early) worker.emplace();
    const Loaded loaded;
    if (!early) worker.emplace();
    return block(loaded, *worker);
  });
}

}  // namespace

TEST(no_memory_for_an_instance_ends_no_process) {
  const std::string uri = resources(everything);
  for (const bool early : {false, true}) {
    bool granted = false;
    for (long request = 0; !granted && check::failures == 0; ++request)
      granted = survived(early, [&](const Loaded& loaded, Worker& worker) {
        worker.run([&] {
          memory::fail_at(request);
          fmi2Component c = loaded.instance(uri);
          memory::fail_no_more();
          CHECK(memory::failed == !c);
        });
        return !memory::failed;
      });
  }
}

TEST(no_memory_for_a_message_ends_no_process) {
  const std::string uri = resources(everything);
  using Call = std::function<fmi2Status(const Loaded&, fmi2Component)>;
  const Call calls[] = {[](const Loaded& l, fmi2Component c) { return l.do_step(c, 7, 0.01, fmi2True); },
                        [](const Loaded& l, fmi2Component c) {
                          fmi2FMUstate state = nullptr;
                          return l.get_state(c, &state);
                        }};
  for (const bool early : {false, true})
    for (const Call& call : calls)
      survived(early, [&](const Loaded& loaded, Worker& worker) {
        fmi2Component c = loaded.instance(uri);
        worker.run([&] {
          memory::fail_at(0);
          const fmi2Status status = call(loaded, c);
          memory::fail_no_more();
          CHECK(status == fmi2Error);
          CHECK(loaded.reset(c) == fmi2OK);
          loaded.free_instance(c);
        });
        return true;
      });
}
#endif
