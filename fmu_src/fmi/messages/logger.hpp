/// Messages to the host, by the rules of FMI 2.0: declared categories only, `%` and `#` doubled, UTF-8, no line break at the end.
#pragma once
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

  fmi2CallbackLogger callback_;
  fmi2ComponentEnvironment environment_;
  std::string instance_name_;
  std::vector<bool> enabled_;
};

/// A value with nine digits, for messages.
std::string number(double value);

}  // namespace softffd::fmi
