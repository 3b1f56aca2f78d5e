/// libFuzzer target: any bytes as an FMU state. They are refused with StateError, the instance untouched, or
/// the instance runs on from them.
///
/// The first byte says how the rest is used: 0 as serialized bytes, head included; 1 as the payload; above,
/// as changes of a sound payload (two bytes say where, eight what), so that mutations get past the checks of
/// size and sign.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "instance.hpp"

using namespace softffd::fmi;

namespace {

SceneFile scene() {
  std::string body =
      "guid {g}\ncounts 2 2 2\nmass 1 1 1 1 1 1 1 1\nstiffness 100 100 100\ndamping 0.05\ngravity 0 0 "
      "-9.81\n";
  body +=
      "plane ground fixed 0 0 0 0.1 0 1 0 0 0 0 0 0 0.4\nplane lid input 0 0 2 0 0 -1 0 0 0 0 0 0 0.1\npin "
      "hand input 7\n";
  body +=
      "load push 0 1\nforces 2\npositions 0 1 2 3 4 5 6 7\ninitial 1 1 1 0 0 0.1 1 0 0 0 0 "
      "0\nreactions\nenergy\nsolver\n";
  std::uint64_t hash = 14695981039346656037u;
  for (unsigned char c : body) hash = (hash ^ c) * 1099511628211u;
  char head[64];
  std::snprintf(head, sizeof head, "softffd-scene 1 %016llx\n", static_cast<unsigned long long>(hash));
  return parse_scene(head + body);
}

Instance fresh() {
  const fmi2CallbackFunctions callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
  return Instance(scene(), Logger(callbacks, "fuzz", true));
}

Instance running() {
  Instance instance = fresh();
  instance.enter_initialization();
  instance.exit_initialization();
  if (instance.do_step(0, 0.01) != fmi2OK) std::abort();
  return instance;
}

Bytes changed(Bytes payload, const std::uint8_t* data, std::size_t size) {
  for (; size >= 10; data += 10, size -= 10) {
    const std::size_t at = 8 * ((data[0] | data[1] << 8) % (payload.size() / 8));
    std::memcpy(payload.data() + at, data + 2, 8);
  }
  return payload;
}

double value_of(Instance& instance, Family family) {
  const fmi2ValueReference reference = unsigned(family) << 24;
  double value = 0;
  instance.get(Type::Real, &reference, 1, &value);
  return value;
}

/// All variables, and a step of few internal steps.
void run_on(Instance& instance) {
  double value = 0;
  for (const FamilyInfo& info : families) {
    const fmi2ValueReference reference = unsigned(info.family) << 24;
    if (instance.phase != instantiated) try {
        instance.get(info.type == Type::Real ? Type::Real : Type::Integer, &reference, 1, &value);
      } catch (const CallError&) {  // the scene has no such variable, or the initial state is refused
      }
  }
  if (instance.phase != stepping) return;
  double step = std::min(0.01, 100 * value_of(instance, Family::solver_stable_step));
  if (const double given = value_of(instance, Family::solver_step); given > 0) step = std::min(step, 100 * given);
  instance.do_step(instance.last_successful_time(), step);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const Instance sound = running();
  Instance instance = sound;
  const Bytes before = instance.save_state();
  const std::span rest(data + 1, size - 1);
  try {
    const Bytes payload = data[0] == 0   ? without_head("{g}", rest)
                          : data[0] == 1 ? Bytes(rest.begin(), rest.end())
                                         : changed(before, rest.data(), rest.size());
    try {
      instance.load_state(payload);
    } catch (const StateError&) {
      if (instance.save_state() != before) std::abort();
      return 0;
    }
    if (instance.save_state() != payload) std::abort();
    run_on(instance);
  } catch (const StateError&) {
  } catch (const CallError&) {
  }
  return 0;
}
