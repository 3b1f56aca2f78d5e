/// Instances without the C functions before them.
#pragma once
#include <cstdlib>
#include <limits>
#include <memory>

#include "check.hpp"
#include "instance/instance.hpp"
#include "small_scene.hpp"

namespace softffd::fmi {

inline std::unique_ptr<Instance> instance_of(const std::string& text, bool logging = true, fmi2CallbackLogger logger = nullptr) {
  return std::make_unique<Instance>(parse_scene(text), Logger({logger, std::calloc, std::free, nullptr, nullptr}, "box", logging));
}

inline void start(Instance& instance, double stop = std::numeric_limits<double>::infinity()) {
  instance.setup_experiment(0, 0, stop);
  instance.enter_initialization();
  instance.exit_initialization();
}

/// Steps number first to last - 1 of 10 ms.
inline void run(Instance& instance, int first, int last) {
  for (int n = first; n < last; ++n) CHECK(instance.do_step(n * 0.01, 0.01) == fmi2OK);
}

inline fmi2ValueReference reference_of(Family family, int index = 0) { return unsigned(family) << 24 | unsigned(index); }

inline double value_of(Instance& instance, Family family, Type type = Type::Real, int index = 0) {
  const fmi2ValueReference reference = reference_of(family, index);
  double value = 0;
  instance.get(type, &reference, 1, &value);
  return value;
}

inline void set_value(Instance& instance, Family family, double value, Type type = Type::Real) {
  const fmi2ValueReference reference = reference_of(family);
  instance.set(type, &reference, 1, &value);
}

/// What a call is refused with; empty: it is not.
template <class Error = CallError, class Call>
std::string refusal(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace softffd::fmi
