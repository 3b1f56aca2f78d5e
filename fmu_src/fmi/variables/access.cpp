/// Sets and gets variables for a host: finds the variables of value references, and checks the values that the host passes.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "variables/variables.hpp"

namespace softffd::fmi {

namespace {

/// Returns the phases in which a variable may be set (FMI 2.0.4, section 4.2.4).
unsigned settable_in(const FamilyInfo& info) {
  if (info.causality == Causality::output) return 0;
  const bool any_time = info.causality == Causality::input || info.variability == Variability::tunable;
  return instantiated | initializing | (any_time ? stepping : 0u);
}

std::string shortest(double value) {
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() ? std::string(text.data(), end) : "?";
}

}  // namespace

const char* Variables::type_name(Type type) const {
  if (standard_ == Standard::fmi3) return type == Type::Real ? "Float64" : "Int64";
  return type == Type::Real ? "Real" : "Integer";
}

Variables::Variable Variables::checked(fmi2ValueReference reference, Type type) const {
  const auto variable = find(reference);
  if (!variable) throw CallError(name(reference) + ": this scene has no such variable");
  const Type own = variable->info().type;
  if (own != type) throw CallError(name(reference) + ": is of type " + type_name(own) + ", got a call for " + type_name(type));
  return *variable;
}

/// True if the value stands for a method that supports the scene.
bool Variables::method_fits(double value) const {
  if (!(value >= 1 && value <= method_count)) return false;
  const Method method = Method(int(value) - 1);
  return (!scene_.definition.samples || meets_surface(method)) && (scene_.definition.free.empty() || takes_free_bodies(method)) &&
         (!scene_.definition.solid() || takes_solid(method, scene_.definition.lattice));
}

void Variables::check_method(double method) const {
  if (method_fits(method)) return;
  std::string wanted;
  for (int value = 1; value <= method_count; ++value)
    if (method_fits(value)) wanted.append(wanted.empty() ? "" : ", ").append(std::to_string(value) + " ").append(methods[value - 1]);
  throw CallError(std::string(families[row_of(Family::solver_method)].name) + ": wanted one of " + wanted +
                  (!scene_.definition.free.empty() ? " (a body is free)"
                   : scene_.definition.solid()     ? " (the body is a solid)"
                   : scene_.definition.samples     ? " (contact is of the surface)"
                                                   : "") +
                  ", got " + shortest(method));
}

void Variables::check_settable(Phase phase, fmi2ValueReference reference, const FamilyInfo& info, double value) const {
  if (!(settable_in(info) & phase))
    throw CallError(name(reference) + ": cannot be set " +
                    (info.causality == Causality::output ? "(it is an output)" : "after initialization"));
  const auto wanted = [&](const std::string& what) {
    const std::string unit = info.unit.empty() || info.unit == "1" ? std::string() : std::string(" ").append(info.unit);
    return CallError(name(reference) + ": wanted " + what + unit + ", got " + shortest(value));
  };
  if (!std::isfinite(value)) throw CallError(name(reference) + ": wanted a finite number, got " + shortest(value));
  if (info.family == Family::solver_method) check_method(value);
  if (value < info.min) throw wanted(">= " + shortest(info.min));
  if (value > info.max) throw wanted("<= " + shortest(info.max));
  if (value <= info.above) throw wanted("> " + shortest(info.above));
}

void Variables::Meant::reserve(std::size_t most) {
  references.reserve(most);
  variables.reserve(most);
  places.reserve(most);
}

const Variables::Meant& Variables::meant(Meant& last, Type type, const fmi2ValueReference* references, std::size_t count) {
  if (last.references.size() == count && std::equal(references, references + count, last.references.begin())) return last;
  last.references.clear();
  last.variables.clear();
  last.places.clear();
  for (std::size_t n = 0; n < count; ++n) {
    const Variable variable = checked(references[n], type);
    last.variables.push_back(variable);
    last.places.push_back(bindings[variable.row].field ? member(variable) + variable.component() * scene_.definition.lattice.points() : 0);
  }
  last.references.assign(references, references + count);
  return last;
}

void Variables::set(Phase phase, Type type, const fmi2ValueReference* references, std::size_t count, const double* numbers) {
  const auto& variables = meant(last_set_[std::size_t(type)], type, references, count).variables;
  for (std::size_t n = 0; n < count; ++n) check_settable(phase, references[n], variables[n].info(), numbers[n]);
  for (std::size_t n = 0; n < count; ++n) {
    const Variable& variable = variables[n];
    values_.numbers[variable.row][variable.index] = numbers[n];
    values_.changed = true;
    values_.material_changed = values_.material_changed || variable.info().material;
  }
}

void Variables::get(Type type, const fmi2ValueReference* references, std::size_t count, double* numbers, SoftBody& body,
                    const ErrorEstimate* estimate) {
  const Meant& list = meant(last_got_[std::size_t(type)], type, references, count);
  const Observed observed{probes_, places_, followed_, body, estimate};
  for (std::size_t n = 0; n < count;) {
    const auto [row, index, place] = list.variables[n];
    if (bindings[row].field) {
      const double* values = bindings[row].field(body).data();
      for (; n < count && list.variables[n].row == row; ++n) numbers[n] = values[list.places[n]];
    } else {
      numbers[n] = bindings[row].is_output ? read(list.variables[n], observed) : values_.numbers[row][index];
      ++n;
    }
  }
}

int Variables::highest_order_of(Family family) { return family == Family::force || family == Family::load ? highest_order : 1; }

void Variables::set_input_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders,
                                      const double* numbers) {
  for (std::size_t n = 0; n < count; ++n) {
    const FamilyInfo& info = checked(references[n], Type::Real).info();
    if (info.causality != Causality::input) throw CallError(name(references[n]) + ": is no input, it has no input derivative");
    if (const int highest = highest_order_of(info.family); orders[n] < 1 || orders[n] > highest)
      throw CallError(name(references[n]) + ": wanted a derivative of order 1" + (highest > 1 ? " to " + std::to_string(highest) : "") +
                      ", got " + std::to_string(orders[n]));
    if (!std::isfinite(numbers[n])) throw CallError(name(references[n]) + ": wanted a finite derivative, got " + shortest(numbers[n]));
  }
  for (std::size_t n = 0; n < count; ++n) {
    const Variable variable = *find(references[n]);
    values_.rates[orders[n] - 1][variable.row][variable.index] = numbers[n];
    values_.changed = values_.rated = true;
  }
}

}  // namespace softffd::fmi
