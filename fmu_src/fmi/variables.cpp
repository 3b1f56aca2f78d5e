/// Setting and getting by value reference: the part of Instance that is driven by the table of variables.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "instance.hpp"

namespace softffd::fmi {

namespace {

const FamilyInfo* family_info(unsigned id) {
  static const auto by_id = [] {
    std::array<const FamilyInfo*, 128> table{};
    for (const FamilyInfo& info : families) table[std::size_t(info.family)] = &info;
    return table;
  }();
  return id < by_id.size() ? by_id[id] : nullptr;
}

int components(const FamilyInfo& info) { return info.components.empty() ? 1 : int(info.components.size()); }

/// Phases in which a variable may be set (FMI 2.0.4, section 4.2.4).
unsigned settable_in(const FamilyInfo& info) {
  if (info.causality == Causality::output) return 0;
  const bool any_time = info.causality == Causality::input || info.variability == Variability::tunable;
  return instantiated | initializing | (any_time ? stepping : 0u);
}

const char* type_name(Type type) { return type == Type::Real ? "Real" : type == Type::Integer ? "Integer" : "Enumeration"; }

void replace(std::string& text, std::string_view placeholder, const std::string& value) {
  const std::size_t at = text.find(placeholder);
  if (at != text.npos) text.replace(at, placeholder.size(), value);
}

std::string shortest(double value) {
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() ? std::string(text.data(), end) : "?";
}

}  // namespace

std::size_t Instance::part_count(Part part) const {
  switch (part) {
    case Part::forces: return scene_.forces.size();
    case Part::loads: return scene_.loads.size();
    case Part::input_planes: return input_planes_.size();
    case Part::fixed_planes: return fixed_planes_.size();
    case Part::planes: return scene_.planes.size();
    case Part::input_pins: return input_pins_.size();
    case Part::always: return 1;
    case Part::damping: return scene_.damping.has_value();
    case Part::gravity: return scene_.gravity.has_value();
    case Part::positions: return scene_.positions.size();
    case Part::velocities: return scene_.velocities.size();
    case Part::probes: return scene_.probes.size();
    case Part::plane_reactions: return scene_.reactions ? scene_.planes.size() : 0;
    case Part::pin_reactions: return scene_.reactions ? scene_.pins.size() : 0;
    case Part::energy: return scene_.energy;
    case Part::energy_gravity: return scene_.energy && scene_.gravity;
    case Part::solver: return scene_.solver;
    case Part::error_estimate: return scene_.error_estimate;
  }
  return 0;
}

std::string Instance::instance_name_of(Part part, int instance) const {
  switch (part) {
    case Part::loads: return scene_.loads[instance].name;
    case Part::input_planes: return scene_.planes[input_planes_[instance]].name;
    case Part::fixed_planes: return scene_.planes[fixed_planes_[instance]].name;
    case Part::planes:
    case Part::plane_reactions: return scene_.planes[instance].name;
    case Part::input_pins: return scene_.pins[input_pins_[instance]].name;
    case Part::pin_reactions: return scene_.pins[instance].name;
    case Part::probes: return scene_.probes[instance].name;
    case Part::forces:
    case Part::positions:
    case Part::velocities:
    case Part::always:
    case Part::damping:
    case Part::gravity:
    case Part::energy:
    case Part::energy_gravity:
    case Part::solver:
    case Part::error_estimate: return {};
  }
  return {};
}

int Instance::control_point_of(Part part, int instance) const {
  if (part == Part::forces) return scene_.forces[instance];
  if (part == Part::positions) return scene_.positions[instance];
  return part == Part::velocities ? scene_.velocities[instance] : 0;
}

void Instance::count_variables() {
  for (const FamilyInfo& info : families) counts_[std::size_t(info.family)] = part_count(info.part) * components(info);
}

std::optional<Instance::Variable> Instance::find(fmi2ValueReference reference) const {
  const unsigned id = reference >> 24;
  const std::size_t index = reference & 0xffffff;
  if (id >= counts_.size() || index >= counts_[id]) return std::nullopt;
  return Variable{family_info(id), int(index)};
}

std::string Instance::name(fmi2ValueReference reference) const {
  const auto variable = find(reference);
  if (!variable) return "value reference " + std::to_string(reference);
  const FamilyInfo& info = *variable->info;
  const int instance = variable->index / components(info), point = control_point_of(info.part, instance);
  const auto& counts = body_.lattice().counts;
  std::string text(info.name);
  replace(text, "{i}", std::to_string(point % counts[0]));
  replace(text, "{j}", std::to_string(point / counts[0] % counts[1]));
  replace(text, "{k}", std::to_string(point / counts[0] / counts[1]));
  replace(text, "{name}", instance_name_of(info.part, instance));
  if (!info.components.empty()) replace(text, "{c}", std::string(1, info.components[variable->index % components(info)]));
  return text;
}

Instance::Variable Instance::checked(fmi2ValueReference reference, Type type) const {
  const auto variable = find(reference);
  if (!variable) throw CallError(name(reference) + ": this scene has no such variable");
  const Type own = variable->info->type, access = own == Type::Enumeration ? Type::Integer : own;
  if (access != type) throw CallError(name(reference) + ": is of type " + type_name(own) + ", got a call for " + type_name(type));
  return *variable;
}

/// Has this scene's lattice the method of this number?
bool Instance::available(double method) const {
  static_assert(widest_layer == LayerMatrix::widest, "variables.toml and layer_matrix.hpp must agree");
  return MethodValue(int(method)) != MethodValue::ros34pw2 || LayerMatrix::fits(body_.lattice());
}

void Instance::check_settable(const Variable& variable, fmi2ValueReference reference, double value) const {
  const FamilyInfo& info = *variable.info;
  if (!(settable_in(info) & phase))
    throw CallError(name(reference) + ": cannot be set " +
                    (info.causality == Causality::output ? "(it is an output)" : "after initialization"));
  const auto wanted = [&](const std::string& what) {
    const std::string unit = info.unit.empty() || info.unit == "1" ? std::string() : std::string(" ").append(info.unit);
    return CallError(name(reference) + ": wanted " + what + unit + ", got " + shortest(value));
  };
  if (!std::isfinite(value)) throw CallError(name(reference) + ": wanted a finite number, got " + shortest(value));
  if (value < info.min) throw wanted(">= " + shortest(info.min));
  if (value <= info.above) throw wanted("> " + shortest(info.above));
  if (info.type == Type::Enumeration && !(value >= 1 && value <= method_count))
    throw CallError(name(reference) + ": wanted 1 to " + std::to_string(method_count) + ", got " + shortest(value));
  if (info.family == Family::solver_method && !available(value))
    throw CallError(name(reference) + ": ros34pw2 is for lattices with at most " + std::to_string(LayerMatrix::widest) +
                    " control points in a layer across the axis with most, this one has " +
                    std::to_string(LayerMatrix::points_per_layer(body_.lattice())) +
                    "; wanted auto (1) or an explicit method, e.g. dop853 (" + std::to_string(int(MethodValue::dop853)) + ")");
}

void Instance::set(Type type, const fmi2ValueReference* references, std::size_t count, const double* numbers) {
  for (std::size_t n = 0; n < count; ++n) check_settable(checked(references[n], type), references[n], numbers[n]);
  for (std::size_t n = 0; n < count; ++n) {
    const unsigned id = references[n] >> 24;
    values_[id][references[n] & 0xffffff] = numbers[n];
    changed_ = true;
    material_changed_ = material_changed_ || family_info(id)->material;
  }
}

void Instance::get(Type type, const fmi2ValueReference* references, std::size_t count, double* numbers) {
  ensure_initial_state();
  for (std::size_t n = 0; n < count; ++n) checked(references[n], type);
  for (std::size_t n = 0; n < count; ++n) {
    const Variable variable = *find(references[n]);
    numbers[n] = output(variable.info->family, variable.index);
  }
}

void Instance::set_input_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders,
                                     const double* numbers) {
  for (std::size_t n = 0; n < count; ++n) {
    const Variable variable = checked(references[n], Type::Real);
    if (variable.info->causality != Causality::input) throw CallError(name(references[n]) + ": is no input, it has no input derivative");
    if (const int highest = highest_order_of(variable.info->family); orders[n] < 1 || orders[n] > highest)
      throw CallError(name(references[n]) + ": wanted a derivative of order 1" + (highest > 1 ? " to " + std::to_string(highest) : "") +
                      ", got " + std::to_string(orders[n]));
    if (!std::isfinite(numbers[n])) throw CallError(name(references[n]) + ": wanted a finite derivative, got " + shortest(numbers[n]));
  }
  for (std::size_t n = 0; n < count; ++n) {
    const Variable variable = *find(references[n]);
    rates_[orders[n] - 1][std::size_t(variable.info->family)][variable.index] = numbers[n];
    changed_ = rated_ = true;
  }
}

void Instance::get_output_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, double* numbers) {
  for (std::size_t n = 0; n < count; ++n) {
    const Family family = checked(references[n], Type::Real).info->family;
    if (family != Family::position && family != Family::probe)
      throw CallError(name(references[n]) + ": has no output derivative; positions and probes have");
    if (orders[n] != 1) throw CallError(name(references[n]) + ": wanted a derivative of order 1, got " + std::to_string(orders[n]));
  }
  for (std::size_t n = 0; n < count; ++n) {
    const Variable variable = *find(references[n]);
    const int instance = variable.index / 3, axis = variable.index % 3;
    const auto v = body_.state().v.col(axis);
    numbers[n] = variable.info->family == Family::position ? v[scene_.positions[instance]] : probes_[instance](v);
  }
}

}  // namespace softffd::fmi
