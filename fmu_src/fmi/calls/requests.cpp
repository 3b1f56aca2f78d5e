#include "calls/requests.hpp"

#include <cmath>
#include <limits>

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
  return instance.logger.warn_caller(std::string(function.name) + ": wanted categories of " + listed(instance.logger.declared()) +
                                     "; passed over " + listed(unknown));
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

}  // namespace softffd::fmi
