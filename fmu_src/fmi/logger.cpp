#include "logger.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "variable_table.hpp"

namespace softffd::fmi {

namespace {

std::ptrdiff_t category_index(std::string_view name) {
  const auto found = std::find(std::begin(log_categories), std::end(log_categories), name);
  return found == std::end(log_categories) ? -1 : found - std::begin(log_categories);
}

std::string escaped(const std::string& message) {
  std::string text;
  for (char c : message) text.append(c == '%' || c == '#' ? 2 : 1, c);
  return text;
}

}  // namespace

Logger::Logger(const fmi2CallbackFunctions& callbacks, std::string instance_name, bool logging_on)
    : callback_(callbacks.logger),
      environment_(callbacks.componentEnvironment),
      instance_name_(std::move(instance_name)),
      enabled_(std::size(log_categories), logging_on) {}

bool Logger::switch_categories(bool on, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (category_index(name) < 0) return false;
  for (std::size_t i = 0; i < enabled_.size(); ++i)
    if (names.empty() || std::find(names.begin(), names.end(), log_categories[i]) != names.end()) enabled_[i] = on;
  return true;
}

bool Logger::on(const char* category) const { return callback_ && enabled_[category_index(category)]; }

void Logger::log(fmi2Status status, const char* category, const std::string& message) const {
  if (!callback_ || (status < fmi2Error && !on(category))) return;
  callback_(environment_, instance_name_.c_str(), status, category, escaped(message).c_str());
}

}  // namespace softffd::fmi
