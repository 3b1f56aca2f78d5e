#include "calls/requests.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include "calls/held_states.hpp"

namespace softffd::fmi {

namespace {

template <class Words>
std::string listed(const Words& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

}  // namespace

fmi2Status switch_logging(Instance& instance, const Function& function, bool on, std::size_t count, const char* const* categories) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.emplace_back(categories[i] ? categories[i] : "(null)");
  const std::vector<std::string> unknown = instance.logger.switch_categories(on, names);
  if (unknown.empty()) return fmi2OK;
  return instance.logger.warn_caller(std::string(function.name) + ": wanted categories of " + listed(log_categories) + "; passed over " +
                                     listed(unknown));
}

void set_up(Instance& instance, const Experiment& experiment) {
  const auto [start, tolerance, stop] = experiment;
  if (!std::isfinite(start)) throw CallError("startTime: wanted a finite number, got " + number(start));
  if (tolerance && !(std::isfinite(*tolerance) && *tolerance > 0))
    throw CallError("tolerance: wanted a finite number > 0, got " + number(*tolerance));
  if (stop && !(std::isfinite(*stop) && *stop > start))
    throw CallError("stopTime: wanted a finite number above startTime, got " + number(*stop));
  instance.setup_experiment(start, tolerance ? *tolerance : 0, stop ? *stop : std::numeric_limits<double>::infinity());
}

void get_state(Instance& instance, StateHandle* state) { hold(state, {&instance, instance.guid(), instance.save_state()}); }

void set_state(Instance& instance, StateHandle state) {
  const auto wanted = held(state);
  if (wanted->guid != instance.guid()) throw StateError("the state belongs to another scene");
  instance.load_state(wanted->bytes);
}

void free_state(StateHandle* state) {
  if (!state || !*state) return;
  held(*state);
  release(*state);
  *state = nullptr;
}

std::size_t serialized_size(StateHandle state) {
  const auto wanted = held(state);
  return head_size(wanted->guid) + wanted->bytes.size();
}

void serialize(StateHandle state, void* bytes, std::size_t size) {
  const auto wanted = held(state);
  const Bytes whole = with_head(wanted->guid, wanted->bytes);
  if (size < whole.size()) throw CallError("size: wanted " + std::to_string(whole.size()) + " bytes, got " + std::to_string(size));
  std::memcpy(bytes, whole.data(), whole.size());
}

void deserialize(Instance& instance, const void* bytes, std::size_t size, StateHandle* state) {
  const std::span serialized(static_cast<const unsigned char*>(bytes), size);
  hold(state, {&instance, instance.guid(), without_head(instance.guid(), serialized)});
}

}  // namespace softffd::fmi
