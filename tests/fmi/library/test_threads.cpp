/// Many threads, each with its own instances and states, logging on: the bits of a run alone, and (with
/// -fsanitize=thread) no data race.
#include <atomic>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

extern "C" {
#include "fmi2Functions.h"
}

#include "check.hpp"
#include "small_scene.hpp"
#include "variable_table.hpp"

using softffd::fmi::Family;

namespace {

constexpr int steps = 20, thread_count = 8, rounds = 4;

/// Two scenes of one library: with and without planes, pins and energy.
std::string resources(bool rich) {
  const std::string more = "damping 0.05\nplane ground fixed 0 0 0 0.1 0 1 0 0 0 0 0 0 0.4\npin hand input 26\nenergy\nsolver\nreactions\n";
  return small_scene::Box{}.resources("gravity 0 0 -9.81\n" + (rich ? more : ""));
}

/// What a thread's host keeps: its messages, and how many were not meant for it.
struct Host {
  int messages = 0, foreign = 0;
  std::string name;
};

void note(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status, fmi2String, fmi2String, ...) {
  Host& host = *static_cast<Host*>(environment);
  ++host.messages;
  host.foreign += host.name != instance;
}

struct Run {
  std::vector<double> positions;
  int errors = 0, messages = 0;
};

int begin(fmi2Component c) {
  return (fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0) != fmi2OK) + (fmi2EnterInitializationMode(c) != fmi2OK) +
         (fmi2ExitInitializationMode(c) != fmi2OK);
}

/// Steps with a rollback in the middle through a serialized state, and a refused call and a reset before.
Run run(const std::string& uri, const std::string& name) {
  Run result;
  Host host{0, 0, name};
  const fmi2CallbackFunctions callbacks{note, std::calloc, std::free, nullptr, &host};
  fmi2Component c = fmi2Instantiate(name.c_str(), fmi2CoSimulation, "{g}", uri.c_str(), &callbacks, fmi2False, fmi2True);
  const fmi2ValueReference mass = unsigned(Family::mass) << 24;
  const double impossible = -1;
  result.errors += fmi2SetReal(c, &mass, 1, &impossible) != fmi2Error;
  result.errors += fmi2Reset(c) != fmi2OK;
  result.errors += begin(c);
  fmi2FMUstate state = nullptr, copy = nullptr;
  std::vector<fmi2Byte> bytes;
  for (int n = 0; n < steps; ++n) {
    if (n == steps / 2) {
      std::size_t size = 0;
      result.errors += fmi2GetFMUstate(c, &state) != fmi2OK;
      result.errors += fmi2SerializedFMUstateSize(c, state, &size) != fmi2OK;
      bytes.resize(size);
      result.errors += fmi2SerializeFMUstate(c, state, bytes.data(), size) != fmi2OK;
      result.errors += fmi2DoStep(c, n * 0.01, 0.02, fmi2True) != fmi2OK;
      result.errors += fmi2DeSerializeFMUstate(c, bytes.data(), size, &copy) != fmi2OK;
      result.errors += fmi2SetFMUstate(c, copy) != fmi2OK;
      result.errors += fmi2FreeFMUstate(c, &state) != fmi2OK;
      result.errors += fmi2FreeFMUstate(c, &copy) != fmi2OK;
    }
    result.errors += fmi2DoStep(c, n * 0.01, 0.01, fmi2True) != fmi2OK;
  }
  result.positions.resize(81);
  std::vector<fmi2ValueReference> references(81);
  for (unsigned i = 0; i < 81; ++i) references[i] = unsigned(Family::position) << 24 | i;
  result.errors += fmi2GetReal(c, references.data(), 81, result.positions.data()) != fmi2OK;
  result.errors += fmi2Terminate(c) != fmi2OK;
  fmi2FreeInstance(c);
  result.errors += host.foreign;
  result.messages = host.messages;
  return result;
}

}  // namespace

TEST(many_threads_give_the_bits_of_a_run_alone_and_the_messages_of_their_own_instance) {
  const std::string uris[] = {resources(false), resources(true)};
  const Run alone[] = {run(uris[0], "alone"), run(uris[1], "alone")};
  CHECK(alone[0].errors == 0 && alone[1].errors == 0 && alone[0].messages > 1);
  CHECK(alone[0].positions != alone[1].positions);
  std::atomic<int> ready = 0, errors = 0, differing = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < thread_count; ++t)
    threads.emplace_back([&, t] {
      for (++ready; ready < thread_count;) std::this_thread::yield();
      for (int round = 0; round < rounds; ++round) {
        const int scene = (t + round) % 2;
        const Run mine = run(uris[scene], "thread " + std::to_string(t));
        errors += mine.errors;
        differing += mine.positions != alone[scene].positions || mine.messages != alone[scene].messages;
      }
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(errors == 0);
  CHECK(differing == 0);
}

TEST(an_instance_may_wander_from_thread_to_thread) {
  const std::string uri = resources(true);
  const Run alone = run(uri, "wanderer");
  Run elsewhere;
  std::thread([&] { elsewhere = run(uri, "wanderer"); }).join();
  CHECK(elsewhere.positions == alone.positions);
  const fmi2CallbackFunctions callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
  fmi2Component c = fmi2Instantiate("wanderer", fmi2CoSimulation, "{g}", uri.c_str(), &callbacks, fmi2False, fmi2True);
  CHECK(begin(c) == 0);
  for (int n = 0; n < steps; ++n) std::thread([&, n] { CHECK(fmi2DoStep(c, n * 0.01, 0.01, fmi2True) == fmi2OK); }).join();
  std::vector<double> positions(81);
  std::vector<fmi2ValueReference> references(81);
  for (unsigned i = 0; i < 81; ++i) references[i] = unsigned(Family::position) << 24 | i;
  CHECK(fmi2GetReal(c, references.data(), 81, positions.data()) == fmi2OK);
  CHECK(positions == alone.positions);
  fmi2FreeInstance(c);
}

TEST(instances_with_threads_of_their_own_give_the_bits_of_one) {
  const small_scene::Box box{.side = 15};  // so large that threads share more than the forces
  const unsigned count = 3 * 15 * 15 * 15;
  const auto end = [&](const std::string& uri) {
    const fmi2CallbackFunctions callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
    fmi2Component c = fmi2Instantiate("shared", fmi2CoSimulation, "{g}", uri.c_str(), &callbacks, fmi2False, fmi2False);
    CHECK(begin(c) == 0);
    for (int n = 0; n < 3; ++n) CHECK(fmi2DoStep(c, n * 0.01, 0.01, fmi2True) == fmi2OK);
    std::vector<double> positions(count);
    std::vector<fmi2ValueReference> references(count);
    for (unsigned i = 0; i < count; ++i) references[i] = unsigned(Family::position) << 24 | i;
    CHECK(fmi2GetReal(c, references.data(), count, positions.data()) == fmi2OK);
    fmi2FreeInstance(c);
    return positions;
  };
  const std::string shared = box.resources("energy\nerror_estimate\nthreads 2\n");
  const std::vector<double> alone = end(box.resources("energy\nerror_estimate\n"));
  std::vector<double> found[3];
  std::vector<std::thread> hosts;
  for (auto& positions : found) hosts.emplace_back([&] { positions = end(shared); });
  for (std::thread& host : hosts) host.join();
  for (const auto& positions : found) CHECK(positions == alone);
}
