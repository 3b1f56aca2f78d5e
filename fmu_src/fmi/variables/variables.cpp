#include "variables/variables.hpp"

#include "model/lobatto.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace softffd::fmi {

namespace {

void replace(std::string& text, std::string_view placeholder, const std::string& value) {
  const std::size_t at = text.find(placeholder);
  if (at != text.npos) text.replace(at, placeholder.size(), value);
}

/// Returns a name with letters, digits and underscores only.
std::string flat(std::string text) {
  text.erase(std::remove(text.begin(), text.end(), ']'), text.end());
  std::replace_if(text.begin(), text.end(), [](char c) { return c == '.' || c == '[' || c == ','; }, '_');
  return text;
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
    case MethodValue::sdirk2: return Method::sdirk2;
  }
  return Method::automatic;
}

void set_starts(const SceneFile& scene, Settings& settings) {
  settings.mass = std::accumulate(scene.definition.mass.begin(), scene.definition.mass.end(), 0.0);
  settings.stiffness = scene.stiffness;
  settings.modulus = scene.modulus.value_or(0);
  settings.poissons_ratio = scene.poissons_ratio.value_or(0);
  settings.damping = scene.damping.value_or(0);
  settings.internal_damping = scene.internal_damping.value_or(0);
  settings.gravity = scene.gravity.value_or(Vec3::Zero());
  settings.rotation = scene.rotation.value_or(Vec3::Zero());
  settings.tolerance = scene.tolerance;
  settings.step = scene.step;
  settings.most_work = scene.most_work;
  std::copy(scene.planes.begin(), scene.planes.end(), settings.planes.begin());
  for (std::size_t a = 0; a < scene.pins.size(); ++a)
    if (scene.pins[a].start) settings.pins[a] = *scene.pins[a].start;
}

Vec3 vector(const Variables::Table& table, Family family, std::size_t instance) {
  return Eigen::Map<const Vec3>(table[row_of(family)].data() + 3 * instance);
}

}  // namespace

Variables::Variables(const SceneFile& scene, Settings& settings, Standard standard) : scene_(scene), standard_(standard) {
  for (const PinMotion& pin : settings.pins) pin_origins_.push_back(pin.position);
  set_starts(scene, settings);
  for (std::size_t row = 0; row < family_count; ++row) {
    const FamilyInfo& info = families[row];
    std::vector<int>& list = members_[std::size_t(info.part)];
    if (list.empty()) list = binding_of(info.part).members(scene);
    if (!info.pose.empty()) choose(row);
    if (differenced(row) && count(row) > 0) {
      differenced_.push_back(row);
      begun_[row].resize(count(row));
    }
    if (info.causality == Causality::output) continue;
    for (int index = 0; index < count(row); ++index) {
      const Variable each = variable(row, index);
      starts_[row].push_back(bindings[row].place ? bindings[row].place(settings, member(each))[each.component()] : 0.0);
    }
    for (int order = 1; order <= highest_order_of(info.family); ++order) values_.rates[order - 1][row].resize(starts_[row].size());
  }
  starts_[row_of(Family::solver_method)] = {double(scene.method)};
  int most = 0;
  for (std::size_t row = 0; row < family_count; ++row) most += count(row);
  for (Meant* last : {&last_set_[0], &last_set_[1], &last_got_[0], &last_got_[1]}) last->reserve(most);
  for (const auto& probe : scene.probes) probes_.push_back(embed(scene.definition.sensed.basis, scene.definition.lattice, probe.at));
  for (const auto& probe : scene.probes) followed_.push_back(probe.followed);
  if (scene.definition.solid())
    for (const auto& probe : scene.probes) places_.emplace_back(scene.definition.lattice, probe.at);
  reset();
}

void Variables::reset() {
  values_.numbers = starts_;
  for (Table& order : values_.rates)
    for (auto& list : order) std::fill(list.begin(), list.end(), 0.0);
  values_.changed = values_.material_changed = true;
  values_.rated = false;
  for (auto& list : begun_) std::fill(list.begin(), list.end(), 0.0);
  last_ = {.before = begun_};
  seen_ = begun_;
  forget_seen();
}

/// Chooses the components of poses that belong to this row: if it has inputs, those that the scene names; if parameters, the others.
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
  const std::size_t element = standard_ == Standard::fmi3 ? element_number(reference) : 0;
  if (element > 0) text.resize(std::min({text.size(), text.find("[{i}"), text.find(".{c}")}));
  if (part.of_points) {
    const auto& counts = scene_.definition.lattice.counts;
    replace(text, "{i}", std::to_string(own % counts[0]));
    replace(text, "{j}", std::to_string(own / counts[0] % counts[1]));
    replace(text, "{k}", std::to_string(own / counts[0] / counts[1]));
  }
  if (part.cell) {
    const std::array<int, 2> at = part.cell(scene_, own);
    replace(text, "{i}", std::to_string(at[0]));
    replace(text, "{j}", std::to_string(at[1]));
  }
  if (part.name)
    for (const char* placeholder : {"{name}", "{obstacle}", "{body}"}) replace(text, placeholder, part.name(scene_, own));
  if (!info.components.empty()) replace(text, "{c}", std::string(1, info.components[variable->component()]));
  if (scene_.flat_names) text = flat(std::move(text));
  return element > 0 ? "element " + std::to_string(element) + " of " + text : text;
}

void Variables::restore(Values values, LastStep last) {
  values_ = std::move(values);
  last_ = std::move(last);
  forget_seen();
}

double Variables::tolerance() const { return values_.numbers[row_of(Family::solver_tolerance)][0]; }

void Variables::set_tolerance(double tolerance) {
  values_.numbers[row_of(Family::solver_tolerance)] = {tolerance};
  values_.changed = true;
}

/// Distributes the forces on points and the loads, or their rates, over the control points, or over the nodes of a solid.
void Variables::spread(const Table& table, Points& force) const {
  force.setZero();
  const auto& points = members(Part::forces);
  for (std::size_t n = 0; n < points.size(); ++n) force.row(points[n]) += vector(table, Family::force, n).array().transpose();
  if (scene_.definition.solid() && !points.empty()) lobatto::to_nodes(scene_.definition.lattice, force);
  for (std::size_t n = 0; n < scene_.loads.size(); ++n) {
    const auto& [name, points, weights] = scene_.loads[n];
    for (std::size_t i = 0; i < points.size(); ++i) force.row(points[i]) += weights[i] * vector(table, Family::load, n).array().transpose();
  }
}

/// Sets velocities to the rate of a pose, if one is given. Components that are not inputs keep their velocities.
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

/// Moves pins along with the initial pose of the body: pins that are not inputs, if the body starts turned, and frames of free bodies.
void Variables::take_pins_along(Settings& settings) const {
  for (std::size_t a = 0; a < scene_.pins.size(); ++a)
    if (!scene_.pins[a].moved_by_input && (scene_.rotation || is_free(scene_.definition, int(a))))
      settings.pins[a] = start_pose(scene_.definition, int(a), pin_origins_[a], settings.rotation);
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
  spread_forces(settings);
  follow_pose(Family::plane_point, settings.planes);
  follow_pose(Family::pin_position, settings.pins);
  take_pins_along(settings);
  values_.changed = false;
  return std::exchange(values_.material_changed, false);
}

/// Most runs have no rates. Rates that are 0 already are not set to 0 again.
void Variables::spread_forces(Settings& settings) {
  if (count(row_of(Family::force)) + count(row_of(Family::load)) == 0) return;
  spread(values_.numbers, settings.force.change());
  MarkedPoints* const force_rates[] = {&settings.force_rate, &settings.force_bend[0], &settings.force_bend[1]};
  for (int n = 0; n < highest_order && (values_.rated || rates_spread_); ++n) spread(values_.rates[n], force_rates[n]->change());
  rates_spread_ = values_.rated;
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
      if (!(std::isfinite(v) && v >= families[row].min && v <= families[row].max && v > families[row].above)) return false;
  for (const Table& order : values.rates)
    for (const auto& list : order)
      for (double v : list)
        if (!std::isfinite(v) || (v != 0 && !values.rated)) return false;
  return method_fits(values.numbers[row_of(Family::solver_method)][0]);
}

}  // namespace softffd::fmi
