/// The floating-point environment that the core's results assume, for the duration of a call: rounding to nearest, denormals kept, no
/// traps. What the host had is restored at the end.
#pragma once
#include <cfenv>

namespace softffd::fmi {

class FloatEnvironment {
 public:
  FloatEnvironment() {
    std::fegetenv(&host_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~FloatEnvironment() { std::fesetenv(&host_); }
  FloatEnvironment(const FloatEnvironment&) = delete;
  FloatEnvironment& operator=(const FloatEnvironment&) = delete;

 private:
  std::fenv_t host_;
};

}  // namespace softffd::fmi
