#include "messages/logger.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <string_view>

namespace softffd::fmi {

namespace {

std::ptrdiff_t category_index(std::string_view name) {
  const auto found = std::find(std::begin(log_categories), std::end(log_categories), name);
  return found == std::end(log_categories) ? -1 : found - std::begin(log_categories);
}

/// Returns the length of the well-formed UTF-8 sequence at the beginning of the text; 0: none, or a control character.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xbf) { return byte(i) >= low && byte(i) <= high; };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f;
  if (first >= 0xc2 && first <= 0xdf) return follows(1) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) return follows(1, first == 0xe0 ? 0xa0 : 0x80, first == 0xed ? 0x9f : 0xbf) && follows(2) ? 3 : 0;
  if (first >= 0xf0 && first <= 0xf4)
    return follows(1, first == 0xf0 ? 0x90 : 0x80, first == 0xf4 ? 0x8f : 0xbf) && follows(2) && follows(3) ? 4 : 0;
  return 0;
}

Logger::Host host_of(const fmi2CallbackFunctions& callbacks, std::string instance_name) {
  if (!callbacks.logger) return {};
  return [log = callbacks.logger, environment = callbacks.componentEnvironment, name = std::move(instance_name)](
             fmi2Status status, const char* category, const char* message) { log(environment, name.c_str(), status, category, message); };
}

}  // namespace

Logger::Logger(Host host, std::string_view doubled, std::vector<std::string_view> categories, bool logging_on)
    : host_(std::move(host)), doubled_(doubled), declared_(std::move(categories)), enabled_(std::size(log_categories), logging_on) {}

Logger::Logger(const fmi2CallbackFunctions& callbacks, std::string instance_name, bool logging_on)
    : Logger(host_of(callbacks, std::move(instance_name)), "%#", {std::begin(log_categories), std::end(log_categories)}, logging_on) {}

std::vector<std::string> Logger::switch_categories(bool on, const std::vector<std::string>& names) {
  std::vector<std::string> unknown;
  std::copy_if(names.begin(), names.end(), std::back_inserter(unknown),
               [&](const auto& name) { return std::ranges::find(declared_, name) == declared_.end(); });
  const auto named = [&](std::string_view name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  const bool all = names.empty() || named(log_all);
  for (std::size_t i = 0; i < enabled_.size(); ++i)
    if (all || named(log_categories[i])) enabled_[i] = on;
  return unknown;
}

bool Logger::on(const char* category) const { return host_ && enabled_[category_index(category)]; }

void Logger::log(fmi2Status status, const char* category, std::string_view message) const {
  if (status >= fmi2Error || on(category)) hand_over(status, category, message);
}

fmi2Status Logger::warn_caller(std::string_view message) const {
  hand_over(fmi2Warning, log_warning, message);
  return fmi2Warning;
}

void Logger::hand_over(fmi2Status status, const char* category, std::string_view message) const {
  if (host_) host_(status, category, escaped(message).c_str());
}

/// Returns the message for the host. A message may repeat any bytes that the host has passed: everything but whole characters becomes `?`.
std::string Logger::escaped(std::string_view message) const {
  std::string text;
  while (!message.empty()) {
    const std::size_t length = character_length(message);
    if (length == 1 && doubled_.find(message[0]) != doubled_.npos) text += message[0];
    text.append(length ? message.substr(0, length) : "?");
    message.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return text;
}

static double two_digits(double value) {
  std::array<char, 32> text;
  const char* end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 1).ptr;
  std::from_chars(text.data(), end, value);
  return value;
}

std::string number(double value) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 9).ptr};
}

std::string estimate(double value) { return number(two_digits(value)); }

std::string within(double bound) {
  double rounded = two_digits(bound);
  for (double factor = 0.99; rounded > bound; factor -= 0.01) rounded = two_digits(factor * bound);
  return number(rounded);
}

}  // namespace softffd::fmi
