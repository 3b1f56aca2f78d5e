/// Where an instance stands in the standard's life cycle, and what a call outside of it is answered with.
#pragma once
#include <limits>
#include <stdexcept>

namespace softffd::fmi {

/// States of the FMI 2.0 co-simulation state machine, as bits for masks.
enum Phase : unsigned { instantiated = 1, initializing = 2, stepping = 4, step_failed = 8, terminated = 16, failed = 32 };

/// A call that the host got wrong or that cannot be done; what() is the message for the log.
struct CallError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The run's time: where it starts and stops, and the communication point that it has reached [s].
struct Times {
  double start = 0, now = 0, stop = std::numeric_limits<double>::infinity();
  bool given = false;  ///< by the host

  /// Throws CallError unless a communication step from `time` goes on from here, has a length and stays within the run.
  void check_step(double time, double step) const;
  /// Length of the run [s]; `expected` where it has no end.
  double horizon(double expected) const;
};

}  // namespace softffd::fmi
