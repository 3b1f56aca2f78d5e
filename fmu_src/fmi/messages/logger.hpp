/// Sends messages to the host by the rules of both standards: declared categories only, UTF-8, no line break at the end. Characters to
/// which a standard gives a meaning are doubled.
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
  /// The host's callback, in a form that does not depend on the standard; may be empty.
  using Host = std::function<void(fmi2Status status, const char* category, const char* message)>;
  /// doubled: the characters to be doubled. categories: those that modelDescription.xml declares.
  Logger(Host host, std::string_view doubled, std::vector<std::string_view> categories, bool logging_on);
  /// Creates the logger of a host of FMI 2.0.
  Logger(const fmi2CallbackFunctions& callbacks, std::string instance_name, bool logging_on);

  const std::vector<std::string_view>& declared() const { return declared_; }
  /// Switches the named categories on or off, or all if there are no names or logAll is among them. Returns the undeclared names.
  std::vector<std::string> switch_categories(bool on, const std::vector<std::string>& names);

  /// True if messages of this category are sent to the host, so that callers need not compose other messages.
  bool on(const char* category) const;
  /// Sends a message to the host if it is an error, or if its category is on.
  void log(fmi2Status status, const char* category, std::string_view message) const;
  /// Sends the reason why a call returns fmi2Warning, always. Returns fmi2Warning.
  fmi2Status warn_caller(std::string_view message) const;

 private:
  void hand_over(fmi2Status status, const char* category, std::string_view message) const;

  std::string escaped(std::string_view message) const;

  Host host_;
  std::string_view doubled_;
  std::vector<std::string_view> declared_;
  std::vector<bool> enabled_;
};

/// Returns a value with nine digits, for messages.
std::string number(double value);
/// Returns a measured or estimated value with two digits, for messages.
std::string estimate(double value);
/// Returns an upper bound with two digits, rounded so that the text does not exceed the bound.
std::string within(double bound);

}  // namespace softffd::fmi
