/// Messages to the host, by the rules of both standards: declared categories only, UTF-8, no line break at the end, and the characters
/// doubled that a standard gives a meaning.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

extern "C" {
#include "fmi2FunctionTypes.h"
}

#include "variable_table.hpp"

namespace softffd::fmi {

class Logger {
 public:
  /// The host's callback, whatever form its standard gives it; may be empty.
  using Host = std::function<void(fmi2Status status, const char* category, const char* message)>;
  /// doubled: the characters with a meaning.
  Logger(Host host, std::string_view doubled, bool logging_on);
  /// A host of FMI 2.0.
  Logger(const fmi2CallbackFunctions& callbacks, std::string instance_name, bool logging_on);

  /// Switches all categories (no names, or logAll among them) or the named ones. Returns the names that are not declared.
  std::vector<std::string> switch_categories(bool on, const std::vector<std::string>& names);

  /// Is a message of this category handed over? Saves composing it.
  bool on(const char* category) const;
  /// Errors are always handed over; anything else only where its category is on.
  void log(fmi2Status status, const char* category, std::string_view message) const;
  /// Why a call returns fmi2Warning: always handed over too. Returns fmi2Warning.
  fmi2Status warn_caller(std::string_view message) const;

 private:
  void hand_over(fmi2Status status, const char* category, std::string_view message) const;

  std::string escaped(std::string_view message) const;

  Host host_;
  std::string_view step_doubling_;
  std::vector<bool> enabled_;
};

/// A value with nine digits, for messages.
std::string number(double value);
/// A measured or estimated value with two digits, for messages.
std::string estimate(double value);
/// A bound with two digits, rounded so that the text is within it.
std::string within(double bound);

}  // namespace softffd::fmi
