/// The functions of FMI 2.0 that get and set variables and their derivatives.
#include <algorithm>
#include <limits>

extern "C" {
#include "fmi2Functions.h"
}

#include "calls/fmi2.hpp"

using namespace softffd::fmi;

namespace {

fmi2Status no_variables(fmi2Component component, const Function& function, const char* type, std::size_t count) noexcept {
  return guarded(component, function, {}, [&](Instance&) {
    if (count > 0) throw CallError(std::string(function.name) + ": there are no " + type + " variables");
  });
}

}  // namespace

extern "C" {

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Real values[]) {
  return guarded(component, function::get_real, {{{"vr", references}, {"value", values}}, count},
                 [&](Instance& instance) { instance.get(Type::Real, references, count, values); });
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count, const fmi2Real values[]) {
  return guarded(component, function::set_real, {{{"vr", references}, {"value", values}}, count},
                 [&](Instance& instance) { instance.set(Type::Real, references, count, values); });
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Integer values[]) {
  return guarded(component, function::get_integer, {{{"vr", references}, {"value", values}}, count}, [&](Instance& instance) {
    constexpr double most = std::numeric_limits<fmi2Integer>::max();
    for (std::size_t i = 0; i < count; ++i) {
      double number = 0;
      instance.get(Type::Integer, references + i, 1, &number);
      values[i] = fmi2Integer(std::min(number, most));
    }
  });
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count, const fmi2Integer values[]) {
  return guarded(component, function::set_integer, {{{"vr", references}, {"value", values}}, count}, [&](Instance& instance) {
    const std::vector<double> numbers(values, values + count);
    instance.set(Type::Integer, references, count, numbers.data());
  });
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference[], size_t count, fmi2Boolean[]) {
  return no_variables(component, function::get_boolean, "Boolean", count);
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference[], size_t count, const fmi2Boolean[]) {
  return no_variables(component, function::set_boolean, "Boolean", count);
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference[], size_t count, fmi2String[]) {
  return no_variables(component, function::get_string, "String", count);
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference[], size_t count, const fmi2String[]) {
  return no_variables(component, function::set_string, "String", count);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference[], size_t, const fmi2ValueReference[], size_t,
                                        const fmi2Real[], fmi2Real[]) {
  return guarded(component, function::directional_derivative, {},
                 [](Instance&) { throw CallError("fmi2GetDirectionalDerivative: not available; modelDescription.xml does not claim it"); });
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                       const fmi2Integer orders[], const fmi2Real values[]) {
  return guarded(component, function::set_input_derivatives, {{{"vr", references}, {"order", orders}, {"value", values}}, count},
                 [&](Instance& instance) { instance.set_input_derivatives(references, count, orders, values); });
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                        const fmi2Integer orders[], fmi2Real values[]) {
  return guarded(component, function::get_output_derivatives, {{{"vr", references}, {"order", orders}, {"value", values}}, count},
                 [&](Instance& instance) { instance.get_output_derivatives(references, count, orders, values); });
}

}  // extern "C"
