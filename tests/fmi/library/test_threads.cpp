/// Many threads, each with its own instances and states, logging on: the bits of a run alone, and (with
/// -fsanitize=thread) no data trial runs.
#include <atomic>
#include <thread>

#include "host.hpp"

using component::begin, component::positions, component::step;

namespace {

constexpr int steps = 20, thread_count = 8, rounds = 4;

/// Two scenes of one library: with and without planes, pins and energy.
std::string scene(bool rich) {
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

struct Outcome {
  std::vector<double> end;
  int errors = 0, messages = 0;
};

/// Steps with a rollback in the middle through a serialized state, and a refused call and a reset before.
Outcome run(const std::string& uri, const std::string& name) {
  Outcome result;
  Host host{0, 0, name};
  fmi2Component c = component::instantiate(uri, fmi2True, "{g}", {note, std::calloc, std::free, nullptr, &host}, name.c_str());
  const auto must = [&](fmi2Status status) { result.errors += status != fmi2OK; };
  result.errors += component::set(c, component::Family::mass, 0, -1) != fmi2Error;
  must(fmi2Reset(c));
  must(begin(c));
  fmi2FMUstate state = nullptr, copy = nullptr;
  std::vector<fmi2Byte> bytes;
  for (int n = 0; n < steps; ++n) {
    if (n == steps / 2) {
      std::size_t size = 0;
      must(fmi2GetFMUstate(c, &state));
      must(fmi2SerializedFMUstateSize(c, state, &size));
      bytes.resize(size);
      must(fmi2SerializeFMUstate(c, state, bytes.data(), size));
      must(fmi2DoStep(c, n * 0.01, 0.02, fmi2True));
      must(fmi2DeSerializeFMUstate(c, bytes.data(), size, &copy));
      must(fmi2SetFMUstate(c, copy));
      must(fmi2FreeFMUstate(c, &state));
      must(fmi2FreeFMUstate(c, &copy));
    }
    must(step(c, n));
  }
  result.end = positions(c);
  must(fmi2Terminate(c));
  fmi2FreeInstance(c);
  result.errors += host.foreign;
  result.messages = host.messages;
  return result;
}

}  // namespace

TEST(many_threads_give_the_bits_of_a_run_alone_and_the_messages_of_their_own_instance) {
  const std::string uris[] = {scene(false), scene(true)};
  const Outcome alone[] = {run(uris[0], "alone"), run(uris[1], "alone")};
  CHECK(alone[0].errors == 0 && alone[1].errors == 0 && alone[0].messages > 1);
  CHECK(alone[0].end != alone[1].end);
  std::atomic<int> ready = 0, errors = 0, differing = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < thread_count; ++t)
    threads.emplace_back([&, t] {
      for (++ready; ready < thread_count;) std::this_thread::yield();
      for (int round = 0; round < rounds; ++round) {
        const int which = (t + round) % 2;
        const Outcome mine = run(uris[which], "thread " + std::to_string(t));
        errors += mine.errors;
        differing += mine.end != alone[which].end || mine.messages != alone[which].messages;
      }
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(errors == 0 && differing == 0);
}

TEST(an_instance_may_wander_from_thread_to_thread) {
  const std::string uri = scene(true);
  const Outcome alone = run(uri, "wanderer");
  Outcome elsewhere;
  std::thread([&] { elsewhere = run(uri, "wanderer"); }).join();
  CHECK(elsewhere.end == alone.end);
  fmi2Component c = component::instantiate(uri, fmi2True);
  CHECK(begin(c) == fmi2OK);
  for (int n = 0; n < steps; ++n) std::thread([&, n] { CHECK(step(c, n) == fmi2OK); }).join();
  CHECK(positions(c) == alone.end);
  fmi2FreeInstance(c);
}

TEST(instances_with_threads_of_their_own_give_the_bits_of_one) {
  const small_scene::Box box{.side = 15};  // so large that threads share more than the forces
  const auto end = [&](const std::string& uri) {
    fmi2Component c = component::started(uri);
    for (int n = 0; n < 3; ++n) CHECK(step(c, n) == fmi2OK);
    const std::vector<double> found = positions(c, 15 * 15 * 15);
    fmi2FreeInstance(c);
    return found;
  };
  const std::string shared = box.resources("energy\nerror_estimate\nthreads 2\n");
  const std::vector<double> alone = end(box.resources("energy\nerror_estimate\n"));
  std::vector<double> found[3];
  std::vector<std::thread> hosts;
  for (auto& each : found) hosts.emplace_back([&] { each = end(shared); });
  for (std::thread& host : hosts) host.join();
  for (const auto& each : found) CHECK(each == alone);
}
