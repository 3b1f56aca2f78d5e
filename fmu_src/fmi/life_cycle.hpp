/// The phases of an instance in the standard's life cycle, its times, and the exception for calls that are not allowed.
#pragma once
#include <limits>
#include <stdexcept>

namespace softffd::fmi {

/// States of the FMI 2.0 co-simulation state machine, as bits for masks.
enum Phase : unsigned { instantiated = 1, initializing = 2, stepping = 4, step_failed = 8, terminated = 16, failed = 32 };

/// The standard whose words messages use.
enum class Standard { fmi2, fmi3 };

/// Thrown if a call of the host is wrong or cannot be carried out; what() is the message for the log.
struct CallError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Times of the run: start, stop, and the communication point that it has reached [s]; its tolerance.
struct Times {
  double start = 0, now = 0, stop = std::numeric_limits<double>::infinity();
  double tolerance = 0;  ///< that the host gave [1]; 0: none
  bool given = false;    ///< the host has set the times

  /// Throws CallError unless a communication step from `time` begins at `now`, advances time and ends within the run, to rounding.
  void check_step(double time, double step) const;
  /// Returns the length of the run [s], or `expected` if there is no stop time.
  double horizon(double expected) const;
};

}  // namespace softffd::fmi
