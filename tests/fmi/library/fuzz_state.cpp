/// libFuzzer target: any bytes as an FMU state. They are refused with StateError, the instance untouched, or the instance runs on from
/// them.
///
/// The first byte says what the bytes are: by its lowest two bits they are taken
///     0  as they are, as a serialized state;
///     1  as a payload, to which the target writes the head, checksum included;
///     2  as changes of a sound payload, which gets its head anew: mutations reach the reader behind the checks;
///     3  as changes of a sound serialized state, head included;
/// the next two bits choose the sound state, so that none has to be found by chance; if the bit after them is not set, the instance takes a
/// step. A change is two bytes that say which word, one that says what becomes of it, and for a word of the input's own eight more.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "instances.hpp"

using namespace softffd::fmi;

namespace {

using Input = std::span<const std::uint8_t>;

constexpr int points = 8, springs_of_a_point = 7;

const std::string text = small_scene::Box{.side = 2, .mass = 1, .stiffness = 100, .initial = "1 1 1 0 0 0.1 1 0 0 0 0 0"}.text(
    "damping 0.05\ngravity 0 0 -9.81\nplane ground fixed 0 0 0 0.1 0 1 0 0 0 0 0 0 0.4\n"
    "plane lid input 0 0 2 0 0 -1 0 0 0 0 0 0 0.1\npin hand input 7\nload push 0 1\nforces 2\nreactions\nenergy\nsolver\n");

std::unique_ptr<Instance> fresh() { return instance_of(text); }

Bytes running(int method, double step) {
  const auto instance = fresh();
  set_value(*instance, Family::solver_method, method, Type::Integer);
  set_value(*instance, Family::solver_step, step);
  instance->enter_initialization();
  instance->exit_initialization();
  for (int n = 0; n < 20; ++n)
    if (instance->do_step(n * 0.01, 0.01) != fmi2OK) std::abort();
  set_value(*instance, Family::stiffness_edge, 150);  // waits for the next step
  return instance->save_state();
}

/// Before initialization; in contact, by an automatic step; by a given one; by the published scheme.
std::unique_ptr<Instance> sound(int which) {
  static const Bytes starts[] = {fresh()->save_state(), running(1, 0), running(3, 0.005), running(2, 0.005)};
  auto instance = fresh();
  instance->load_state(starts[which]);
  return instance;
}

std::uint64_t word_of(double value) { return std::bit_cast<std::uint64_t>(value); }

Bytes changed(Bytes bytes, Input input) {
  using Limits = std::numeric_limits<double>;
  constexpr std::uint64_t one = 1;
  static const double numbers[] = {0.0,
                                   -0.0,
                                   1.0,
                                   -1.0,
                                   Limits::infinity(),
                                   Limits::quiet_NaN(),
                                   Limits::max(),
                                   Limits::min(),
                                   Limits::denorm_min(),
                                   1e-9,
                                   1e9,
                                   -Limits::infinity(),
                                   -Limits::max()};
  static const std::uint64_t words[] = {1, 2, 4, 8, 16, 32, one << 53, 20'000'000, ~(one << 63), ~std::uint64_t{0}, one << 63};
  while (input.size() >= 3) {
    const std::size_t at = 8 * ((input[0] | input[1] << 8) % (bytes.size() / 8)), kind = input[2];
    input = input.subspan(3);
    const std::size_t chosen = kind % (std::size(numbers) + std::size(words));
    std::uint64_t word = chosen < std::size(numbers) ? word_of(numbers[chosen]) : words[chosen - std::size(numbers)];
    if (kind >= 128) {
      if (input.size() < 8) break;
      std::memcpy(&word, input.data(), 8);
      input = input.subspan(8);
    }
    std::memcpy(bytes.data() + at, &word, 8);
  }
  return bytes;
}

/// The payload that the input stands for. Throws StateError.
Bytes payload(unsigned kind, Input input, const Bytes& good) {
  if (kind == 0) return without_head("{g}", input);
  if (kind == 3) return without_head("{g}", changed(with_head("{g}", good), input));
  const Bytes wanted = kind == 1 ? Bytes(input.begin(), input.end()) : changed(good, input);
  if (without_head("{g}", with_head("{g}", wanted)) != wanted) std::abort();
  return wanted;
}

/// A communication step of few internal steps, whatever the material has become [s].
double short_step(Instance& instance) {
  double stiffest = 0;
  for (Family kind : {Family::stiffness_edge, Family::stiffness_face, Family::stiffness_body})
    stiffest = std::max(stiffest, value_of(instance, kind));
  const double by_values = std::sqrt(2 * value_of(instance, Family::mass) / points / (springs_of_a_point * stiffest));
  const double stable = std::min(by_values, value_of(instance, Family::solver_stable_step));  // values may wait, or be those in effect
  const double given = value_of(instance, Family::solver_step), step = std::min(0.01, 8 * stable);
  return given > 0 && given < 8 * stable ? std::min(step, 3 * given) : step;
}

/// All variables, and a step if wanted.
void run_on(Instance& instance, bool stepped) {
  double value = 0;
  for (const FamilyInfo& info : families) {
    const fmi2ValueReference reference = unsigned(info.family) << 24;
    if (instance.phase != instantiated) try {
        instance.get(info.type, &reference, 1, &value);
      } catch (const CallError&) {  // the scene has no such variable, or the initial state is refused
      }
  }
  if (stepped && instance.phase == stepping) instance.do_step(instance.last_successful_time(), short_step(instance));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto started = sound(data[0] >> 2 & 3);
  Instance& instance = *started;
  const Bytes before = instance.save_state();
  try {
    const Bytes wanted = payload(data[0] & 3, Input(data + 1, size - 1), before);
    try {
      instance.load_state(wanted);
    } catch (const StateError&) {
      if (wanted == before || instance.save_state() != before) std::abort();
      return 0;
    }
    if (instance.save_state() != wanted) std::abort();
    run_on(instance, !(data[0] & 16));
  } catch (const StateError&) {
  } catch (const CallError&) {
  }
  return 0;
}
