#include "variables/variables.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "matrix/layer_matrix.hpp"

namespace softffd::fmi {

namespace {

constexpr std::size_t no_row = family_count;

/// Where a family's row is in the table, by its id.
constexpr auto rows_by_id = [] {
  std::array<std::size_t, 128> rows{};
  rows.fill(no_row);
  for (std::size_t row = 0; row < family_count; ++row) rows[std::size_t(families[row].family)] = row;
  return rows;
}();
constexpr std::size_t row_of(Family family) { return rows_by_id[std::size_t(family)]; }

int highest_order_of(Family family) { return family == Family::force || family == Family::load ? Variables::highest_order : 1; }

/// Phases in which a variable may be set (FMI 2.0.4, section 4.2.4).
unsigned settable_in(const FamilyInfo& info) {
  if (info.causality == Causality::output) return 0;
  const bool any_time = info.causality == Causality::input || info.variability == Variability::tunable;
  return instantiated | initializing | (any_time ? stepping : 0u);
}

const char* type_name(Type type) { return type == Type::Real ? "Real" : "Integer"; }

void replace(std::string& text, std::string_view placeholder, const std::string& value) {
  const std::size_t at = text.find(placeholder);
  if (at != text.npos) text.replace(at, placeholder.size(), value);
}

std::string shortest(double value) {
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() ? std::string(text.data(), end) : "?";
}

Method method_of(double value) {
  switch (MethodValue(int(value))) {
    case MethodValue::automatic: return Method::automatic;
    case MethodValue::central_difference: return Method::central_difference;
    case MethodValue::leapfrog: return Method::leapfrog;
    case MethodValue::bm4: return Method::bm4;
    case MethodValue::rkn12: return Method::rkn12;
    case MethodValue::dop853: return Method::dop853;
    case MethodValue::ros34pw2: return Method::ros34pw2;
    case MethodValue::backward_euler: return Method::backward_euler;
  }
  return Method::automatic;
}

void set_starts(const SceneFile& scene, Settings& settings) {
  settings.mass = std::accumulate(scene.definition.mass.begin(), scene.definition.mass.end(), 0.0);
  settings.stiffness = scene.stiffness;
  settings.damping = scene.damping.value_or(0);
  settings.gravity = scene.gravity.value_or(Vec3::Zero());
  settings.tolerance = scene.tolerance;
  settings.step = scene.step;
  settings.most_work = scene.most_work;
  std::copy(scene.planes.begin(), scene.planes.end(), settings.planes.begin());
}

Vec3 vector(const Variables::Table& table, Family family, std::size_t instance) {
  return Eigen::Map<const Vec3>(table[row_of(family)].data() + 3 * instance);
}

}  // namespace

Variables::Variables(const SceneFile& scene, Settings& settings) : scene_(scene) {
  set_starts(scene, settings);
  for (std::size_t row = 0; row < family_count; ++row) {
    const FamilyInfo& info = families[row];
    std::vector<int>& list = members_[std::size_t(info.part)];
    if (list.empty()) list = binding_of(info.part).members(scene);
    if (!info.pose.empty()) choose(row);
    if (differenced(row)) begun_[row].resize(count(row));
    if (info.causality == Causality::output) continue;
    for (int index = 0; index < count(row); ++index) {
      const Variable each = variable(row, index);
      starts_.numbers[row].push_back(bindings[row].place ? bindings[row].place(settings, member(each))[each.component()] : 0.0);
    }
    for (int order = 1; order <= highest_order_of(info.family); ++order) starts_.rates[order - 1][row].resize(starts_.numbers[row].size());
  }
  starts_.numbers[row_of(Family::solver_method)] = {double(scene.method)};
  for (const auto& probe : scene.probes) probes_.push_back(embed(scene.basis, scene.definition.lattice, probe.at));
  reset();
}

void Variables::reset() {
  values_ = starts_;
  for (auto& list : begun_) std::fill(list.begin(), list.end(), 0.0);
  last_ = {.before = begun_};
  seen_ = begun_;
  forget_seen();
}

/// The components of a pose that are of this row: of inputs those that the scene names, of parameters the others.
void Variables::choose(std::size_t row) {
  const FamilyInfo& info = families[row];
  const std::vector<int>& list = members(info.part);
  for (std::size_t n = 0; n < list.size(); ++n)
    for (int c = 0; c < components_of(row); ++c)
      if (binding_of(info.part).by_input(scene_, list[n], std::string(info.pose) + "." + info.components[c]) ==
          (info.causality == Causality::input))
        chosen_[row].push_back(int(n) * components_of(row) + c);
}

int Variables::count(std::size_t row) const {
  return families[row].pose.empty() ? int(members(families[row].part).size()) * components_of(row) : int(chosen_[row].size());
}

std::optional<Variables::Variable> Variables::find(fmi2ValueReference reference) const {
  const unsigned id = reference >> 24;
  const std::size_t row = id < rows_by_id.size() ? rows_by_id[id] : no_row;
  const int index = int(reference & 0xffffff);
  if (row == no_row || index >= count(row)) return std::nullopt;
  return variable(row, index);
}

std::string Variables::name(fmi2ValueReference reference) const {
  const auto variable = find(reference);
  if (!variable) return "value reference " + std::to_string(reference);
  const FamilyInfo& info = variable->info();
  const PartBinding& part = binding_of(info.part);
  const int own = member(*variable);
  std::string text(info.name);
  if (part.of_points) {
    const auto& counts = scene_.definition.lattice.counts;
    if (scene_.plain_names) replace(text, "[{i},{j},{k}]", "_{i}_{j}_{k}");
    replace(text, "{i}", std::to_string(own % counts[0]));
    replace(text, "{j}", std::to_string(own / counts[0] % counts[1]));
    replace(text, "{k}", std::to_string(own / counts[0] / counts[1]));
  }
  if (part.name) replace(text, "{name}", part.name(scene_, own));
  if (!info.components.empty()) replace(text, "{c}", std::string(1, info.components[variable->component()]));
  return text;
}

Variables::Variable Variables::checked(fmi2ValueReference reference, Type type) const {
  const auto variable = find(reference);
  if (!variable) throw CallError(name(reference) + ": this scene has no such variable");
  const Type own = variable->info().type;
  if (own != type) throw CallError(name(reference) + ": is of type " + type_name(own) + ", got a call for " + type_name(type));
  return *variable;
}

void Variables::check_method(double method) const {
  const Lattice& lattice = scene_.definition.lattice;
  const std::string name(families[row_of(Family::solver_method)].name);
  if (!(method >= 1 && method <= method_count)) {
    std::string wanted;
    for (int value = 1; value <= method_count; ++value)
      if (has_method(lattice, value))
        wanted.append(wanted.empty() ? "" : ", ").append(std::to_string(value) + " ").append(methods[value - 1].name);
    throw CallError(name + ": wanted one of " + wanted + ", got " + shortest(method));
  }
  if (!has_method(lattice, int(method)))
    throw CallError(name + ": " + std::string(methods[int(method) - 1].name) + " is for lattices with at most " +
                    std::to_string(LayerMatrix::widest) + " control points in a layer across the axis with most, this one has " +
                    std::to_string(LayerMatrix::points_per_layer(lattice)) + "; wanted auto (1) or an explicit method, e.g. dop853 (" +
                    std::to_string(int(MethodValue::dop853)) + ")");
}

void Variables::check_settable(Phase phase, fmi2ValueReference reference, Type type, double value) const {
  const FamilyInfo& info = checked(reference, type).info();
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
  if (value <= info.above) throw wanted("> " + shortest(info.above));
}

void Variables::set(Phase phase, Type type, const fmi2ValueReference* references, std::size_t count, const double* numbers) {
  for (std::size_t n = 0; n < count; ++n) check_settable(phase, references[n], type, numbers[n]);
  for (std::size_t n = 0; n < count; ++n) {
    const Variable variable = *find(references[n]);
    values_.numbers[variable.row][variable.index] = numbers[n];
    values_.changed = true;
    values_.material_changed = values_.material_changed || variable.info().material;
  }
}

void Variables::get(Type type, const fmi2ValueReference* references, std::size_t count, double* numbers, SoftBody& body,
                    const ErrorEstimate* estimate) {
  for (std::size_t n = 0; n < count; ++n) checked(references[n], type);
  const Observed observed{probes_, body, estimate};
  for (std::size_t n = 0; n < count; ++n) {
    const Variable variable = *find(references[n]);
    numbers[n] = bindings[variable.row].output ? read(variable, observed) : values_.numbers[variable.row][variable.index];
  }
}

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

void Variables::restore(Values values, LastStep last) {
  values_ = std::move(values);
  last_ = std::move(last);
  forget_seen();
}

void Variables::set_tolerance(double tolerance) {
  values_.numbers[row_of(Family::solver_tolerance)] = {tolerance};
  values_.changed = true;
}

/// Forces of points and loads, or their rates, on the control points.
void Variables::spread(const Table& table, Points& force) const {
  const auto& points = members(Part::forces);
  for (std::size_t n = 0; n < points.size(); ++n) force.row(points[n]) += vector(table, Family::force, n).array().transpose();
  for (std::size_t n = 0; n < scene_.loads.size(); ++n)
    for (int p : scene_.loads[n].points)
      force.row(p) += vector(table, Family::load, n).array().transpose() / double(scene_.loads[n].points.size());
}

/// The rate of a pose, where one is given, is the velocity; components that are no inputs keep theirs.
template <class Motions>
void Variables::follow_pose(Family pose, Motions& moved) const {
  const std::size_t row = row_of(pose);
  const std::vector<double>& rates = values_.rates[0][row];
  const auto of = [&](int index) { return member(variable(row, index)); };
  for (int first = 0, end = 0; first < count(row); first = end) {
    while (end < count(row) && of(end) == of(first)) ++end;
    if (std::all_of(&rates[first], &rates[first] + (end - first), [](double rate) { return rate == 0; })) continue;
    for (int index = first; index < end; ++index) {
      const int axis = variable(row, index).component();
      moved[of(index)].velocity[axis] = rates[index];
      moved[of(index)].acceleration[axis] = 0;
    }
  }
}

bool Variables::apply(Settings& settings) {
  forget_seen();
  const Table &numbers = values_.numbers, &rates = values_.rates[0];
  for (std::size_t row = 0; row < family_count; ++row) {
    const Binding& binding = bindings[row];
    if (!binding.place || (families[row].material && !values_.material_changed)) continue;
    for (int index = 0; index < count(row); ++index) {
      const Variable each = variable(row, index);
      binding.place(settings, member(each))[each.component()] = numbers[row][index];
      if (binding.rate_place) binding.rate_place(settings, member(each))[each.component()] = rates[row][index];
    }
  }
  settings.method = method_of(numbers[row_of(Family::solver_method)][0]);
  settings.force.setZero();
  spread(numbers, settings.force);
  Points* const force_rates[] = {&settings.force_rate, &settings.force_bend[0], &settings.force_bend[1]};
  for (int order = 1; order <= highest_order; ++order) {
    force_rates[order - 1]->setZero();
    if (values_.rated) spread(values_.rates[order - 1], *force_rates[order - 1]);
  }
  follow_pose(Family::plane_point, settings.planes);
  follow_pose(Family::pin_position, settings.pins);
  values_.changed = false;
  return std::exchange(values_.material_changed, false);
}

void Variables::forget_rates() {
  if (!values_.rated) return;
  for (Table& order : values_.rates)
    for (auto& list : order) std::fill(list.begin(), list.end(), 0.0);
  values_.rated = false;
  values_.changed = true;
}

bool Variables::sound(const Values& values) const {
  for (std::size_t row = 0; row < family_count; ++row)
    for (double v : values.numbers[row])
      if (!(std::isfinite(v) && v >= families[row].min && v > families[row].above)) return false;
  const double method = values.numbers[row_of(Family::solver_method)][0];
  return method >= 1 && method <= method_count && has_method(scene_.definition.lattice, int(method));
}

}  // namespace softffd::fmi
