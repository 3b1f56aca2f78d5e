#include "variables/bindings.hpp"

#include <numeric>

namespace softffd::fmi {

namespace {

template <auto list>
std::vector<int> all(const SceneFile& s) {
  std::vector<int> members((s.*list).size());
  std::iota(members.begin(), members.end(), 0);
  return members;
}

template <auto list>
std::vector<int> reacting(const SceneFile& s) {
  return s.reactions ? all<list>(s) : std::vector<int>();
}

template <auto list>
std::vector<int> moved(const SceneFile& s) {
  std::vector<int> members;
  for (std::size_t n = 0; n < (s.*list).size(); ++n)
    if ((s.*list)[n].moved_by_input) members.push_back(int(n));
  return members;
}

template <class List, class Test>
std::vector<int> those(const List& list, Test test) {
  std::vector<int> members;
  for (std::size_t n = 0; n < list.size(); ++n)
    if (test(list[n])) members.push_back(int(n));
  return members;
}
template <bool are_boxes>
std::vector<int> planes_that(const SceneFile& s) {
  return those(s.planes, [](const auto& plane) { return plane.box() == are_boxes; });
}

/// Returns the planes or pins that are free bodies, or those that are not.
template <auto list, bool are_free>
std::vector<int> free_ones(const SceneFile& s) {
  return those(s.*list, [](const auto& one) { return (one.free >= 0) == are_free; });
}
template <auto list, bool are_free>
std::vector<int> reacting_ones(const SceneFile& s) {
  return s.reactions ? free_ones<list, are_free>(s) : std::vector<int>();
}
std::vector<int> bodies(const SceneFile& s) {
  return those(s.definition.free, [](const FreeBody&) { return true; });
}
std::vector<int> turning_bodies(const SceneFile& s) {
  return those(s.definition.free, [](const FreeBody& body) { return !body.guided(); });
}
std::vector<int> turning_obstacles(const SceneFile& s) {
  return those(s.planes, [&](const auto& plane) { return plane.free >= 0 && !s.definition.free[plane.free].guided(); });
}
std::string body(const SceneFile& s, int member) {
  const FreeBody& free = s.definition.free[member];
  return free.plane >= 0 ? s.planes[free.plane].path() : s.pins[free.pin].path();
}

template <auto list>
bool by_input(const SceneFile& s, int member, std::string_view component) {
  const auto& one = (s.*list)[member];
  return one.moved_by_input && (!one.inputs || one.inputs->contains(component));
}

template <auto points>
std::vector<int> listed(const SceneFile& s) {
  return s.*points;
}

std::vector<int> one_if(bool present) { return std::vector<int>(present, 0); }

template <auto list>
std::string name_in(const SceneFile& s, int member) {
  return (s.*list)[member].name;
}

template <auto asked>
std::vector<int> probes_with(const SceneFile& s) {
  std::vector<int> members;
  for (std::size_t n = 0; n < s.probes.size(); ++n)
    if (s.probes[n].*asked) members.push_back(int(n));
  return members;
}

std::string sensor(const SceneFile& s, int member) { return s.sensors[member]; }
/// Returns the probes that show the largest value of the quantity `asked`.
template <auto asked>
std::vector<int> largest_of(const SceneFile& s) {
  std::vector<int> members;
  for (std::size_t n = 0; n < s.probes.size(); ++n)
    if (s.probes[n].maximum && s.probes[n].*asked) members.push_back(int(n));
  return members;
}

std::string obstacle(const SceneFile& s, int member) { return s.planes[member].path(); }

constexpr auto planes = &SceneFile::planes;
constexpr auto pins = &SceneFile::pins;

constexpr PartBinding part_bindings[] = {
    {Part::forces, listed<&SceneFile::forces>, nullptr, true},
    {Part::loads, all<&SceneFile::loads>, name_in<&SceneFile::loads>},
    {Part::input_planes, all<planes>, obstacle, false, nullptr, by_input<planes>},
    {Part::input_normals, planes_that<false>, obstacle, false, nullptr, by_input<planes>},
    {Part::input_boxes, planes_that<true>, obstacle, false, nullptr, by_input<planes>},
    {Part::input_motions, free_ones<planes, false>, obstacle, false, nullptr, by_input<planes>},
    {Part::input_pins, moved<pins>, name_in<pins>, false, nullptr, by_input<pins>},
    {Part::fixed_planes, all<planes>, obstacle, false, nullptr, by_input<planes>},
    {Part::fixed_normals, planes_that<false>, obstacle, false, nullptr, by_input<planes>},
    {Part::fixed_boxes, planes_that<true>, obstacle, false, nullptr, by_input<planes>},
    {Part::fixed_motions, free_ones<planes, false>, obstacle, false, nullptr, by_input<planes>},
    {Part::fixed_pins, moved<pins>, name_in<pins>, false, nullptr, by_input<pins>},
    {Part::planes, all<planes>, obstacle},
    {Part::always, [](const SceneFile&) { return one_if(true); }},
    {Part::stiffness, [](const SceneFile& s) { return one_if(!s.modulus); }},
    {Part::modulus, [](const SceneFile& s) { return one_if(s.modulus.has_value()); }},
    {Part::solid, [](const SceneFile& s) { return one_if(s.poissons_ratio.has_value()); }},
    {Part::damping, [](const SceneFile& s) { return one_if(s.damping.has_value()); }},
    {Part::internal_damping, [](const SceneFile& s) { return one_if(s.internal_damping.has_value()); }},
    {Part::gravity, [](const SceneFile& s) { return one_if(s.gravity.has_value()); }},
    {Part::rotation, [](const SceneFile& s) { return one_if(s.rotation.has_value()); }},
    {Part::positions, listed<&SceneFile::positions>, nullptr, true},
    {Part::velocities, listed<&SceneFile::velocities>, nullptr, true},
    {Part::probes, all<&SceneFile::probes>, name_in<&SceneFile::probes>},
    {Part::probe_stress, probes_with<&SceneFile::Probe::stress>, name_in<&SceneFile::probes>},
    {Part::probe_von_mises, probes_with<&SceneFile::Probe::von_mises>, name_in<&SceneFile::probes>},
    {Part::probe_stretch, probes_with<&SceneFile::Probe::stretch>, name_in<&SceneFile::probes>},
    {Part::probe_velocity, probes_with<&SceneFile::Probe::velocity>, name_in<&SceneFile::probes>},
    {Part::probe_acceleration, probes_with<&SceneFile::Probe::acceleration>, name_in<&SceneFile::probes>},
    {Part::probe_largest_velocity, largest_of<&SceneFile::Probe::velocity>, name_in<&SceneFile::probes>},
    {Part::probe_largest_acceleration, largest_of<&SceneFile::Probe::acceleration>, name_in<&SceneFile::probes>},
    {Part::probe_largest_von_mises, largest_of<&SceneFile::Probe::von_mises>, name_in<&SceneFile::probes>},
    {Part::sensors, all<&SceneFile::sensors>, sensor},
    {Part::taxels, all<&SceneFile::taxels>, [](const SceneFile& s, int member) { return s.sensors[s.taxels[member].sensor]; }, false,
     [](const SceneFile& s, int member) { return s.taxels[member].at; }},
    {Part::plane_reactions, reacting<planes>, obstacle},
    {Part::plane_torques, reacting_ones<planes, false>, obstacle},
    {Part::pin_reactions, reacting<pins>, name_in<pins>},
    {Part::pin_torques, reacting_ones<pins, false>, name_in<pins>},
    {Part::energy, [](const SceneFile& s) { return one_if(s.energy); }},
    {Part::energy_gravity, [](const SceneFile& s) { return one_if(s.energy && s.gravity); }},
    {Part::solver, [](const SceneFile& s) { return one_if(s.solver); }},
    {Part::error_estimate, [](const SceneFile& s) { return one_if(s.error_estimate); }},
    {Part::free_bodies, bodies, body},
    {Part::turning_bodies, turning_bodies, body},
    {Part::free_obstacles, free_ones<planes, true>, obstacle},
    {Part::turning_obstacles, turning_obstacles, obstacle},
    {Part::free_plane_reactions, reacting_ones<planes, true>, obstacle},
    {Part::free_pin_reactions, reacting_ones<pins, true>, name_in<pins>},
};

constexpr bool every_part_is_bound() {
  for (const FamilyInfo& info : families)
    if (std::size_t(info.part) >= std::size(part_bindings) || part_bindings[std::size_t(info.part)].part != info.part) return false;
  return true;
}
static_assert(every_part_is_bound(), "part_bindings must have the parts of variables.toml, in the order of their first family");

template <auto field>
double* of_plane(Settings& s, int q) {
  return (s.planes[q].*field).data();
}
template <auto field>
double* of_pin(Settings& s, int a) {
  return (s.pins[a].*field).data();
}

template <auto field>
double* of_free(Settings& s, int k) {
  return (s.free[k].*field).data();
}

/// For families whose values are put into the settings by code of their own (Variables::apply).
constexpr Binding spread(Family family) { return {.family = family}; }
constexpr Binding setting(Family family, Binding::Place place, Binding::Place rate = nullptr) {
  return {.family = family, .place = place, .rate_place = rate};
}
constexpr Binding output(Family family, Binding::Output output, Binding::Output rate = nullptr) {
  return {.family = family, .is_output = true, .output = output, .rate_output = rate};
}
MaterialState material_at(const Observed& o, int probe) { return o.body.solid()->at(o.places[probe], o.body.state().x); }
FreeState free_state(const Observed& o, int k) { return o.body.free_body(k); }
const PointReading& followed(const Observed& o, int probe) { return o.body.readings().followed(o.followed[probe]); }
template <int row, int column>
constexpr Binding stress(Family family) {
  return output(family, [](const Observed& o, int n, int) { return material_at(o, n).stress(row, column); });
}
constexpr Binding field(Family family, Binding::Field field, Binding::Output rate = nullptr) {
  return {.family = family, .is_output = true, .field = field, .rate_output = rate};
}

}  // namespace

constexpr std::array<Binding, family_count> bindings{
    spread(Family::force),
    spread(Family::load),
    setting(Family::plane_point, of_plane<&PlaneMotion::point>),
    setting(Family::plane_normal, of_plane<&PlaneMotion::normal>, of_plane<&PlaneMotion::normal_rate>),
    setting(Family::plane_rotation, of_plane<&PlaneMotion::rotation>, of_plane<&PlaneMotion::rotation_rate>),
    setting(Family::plane_velocity, of_plane<&PlaneMotion::velocity>, of_plane<&PlaneMotion::acceleration>),
    setting(Family::plane_angular_velocity, of_plane<&PlaneMotion::angular_velocity>, of_plane<&PlaneMotion::angular_acceleration>),
    setting(Family::pin_position, of_pin<&PinMotion::position>),
    setting(Family::pin_orientation, of_pin<&PinMotion::orientation>, of_pin<&PinMotion::orientation_rate>),
    setting(Family::pin_velocity, of_pin<&PinMotion::velocity>, of_pin<&PinMotion::acceleration>),
    setting(Family::pin_angular_velocity, of_pin<&PinMotion::angular_velocity>, of_pin<&PinMotion::angular_acceleration>),
    setting(Family::fixed_plane_point, of_plane<&PlaneMotion::point>),
    setting(Family::fixed_plane_normal, of_plane<&PlaneMotion::normal>),
    setting(Family::fixed_plane_rotation, of_plane<&PlaneMotion::rotation>),
    setting(Family::fixed_plane_velocity, of_plane<&PlaneMotion::velocity>),
    setting(Family::fixed_plane_angular_velocity, of_plane<&PlaneMotion::angular_velocity>),
    setting(Family::fixed_pin_position, of_pin<&PinMotion::position>),
    setting(Family::fixed_pin_orientation, of_pin<&PinMotion::orientation>),
    setting(Family::fixed_pin_velocity, of_pin<&PinMotion::velocity>),
    setting(Family::fixed_pin_angular_velocity, of_pin<&PinMotion::angular_velocity>),
    setting(Family::plane_friction, [](Settings& s, int q) { return &s.planes[q].friction; }),
    setting(Family::mass, [](Settings& s, int) { return &s.mass; }),
    setting(Family::stiffness_edge, [](Settings& s, int) { return &s.stiffness.edge; }),
    setting(Family::stiffness_face, [](Settings& s, int) { return &s.stiffness.face; }),
    setting(Family::stiffness_body, [](Settings& s, int) { return &s.stiffness.body; }),
    setting(Family::youngs_modulus, [](Settings& s, int) { return &s.modulus; }),
    setting(Family::poissons_ratio, [](Settings& s, int) { return &s.poissons_ratio; }),
    setting(Family::damping, [](Settings& s, int) { return &s.damping; }),
    setting(Family::internal_damping, [](Settings& s, int) { return &s.internal_damping; }),
    setting(Family::gravity, [](Settings& s, int) { return s.gravity.data(); }),
    setting(Family::initial_rotation, [](Settings& s, int) { return s.rotation.data(); }),
    spread(Family::solver_method),
    setting(Family::solver_tolerance, [](Settings& s, int) { return &s.tolerance; }),
    setting(Family::solver_step, [](Settings& s, int) { return &s.step; }),
    field(
        Family::position, [](const SoftBody& body) -> const Points& { return body.positions(); },
        [](const Observed& o, int p, int axis) { return o.body.velocities()(p, axis); }),
    field(Family::velocity, [](const SoftBody& body) -> const Points& { return body.velocities(); }),
    output(
        Family::probe, [](const Observed& o, int n, int axis) { return o.probes[n](o.body.state().x.col(axis)); },
        [](const Observed& o, int n, int axis) { return o.probes[n](o.body.state().v.col(axis)); }),
    stress<0, 0>(Family::probe_stress_xx),
    stress<1, 1>(Family::probe_stress_yy),
    stress<2, 2>(Family::probe_stress_zz),
    stress<0, 1>(Family::probe_stress_xy),
    stress<0, 2>(Family::probe_stress_xz),
    stress<1, 2>(Family::probe_stress_yz),
    output(Family::probe_von_mises, [](const Observed& o, int n, int) { return material_at(o, n).von_mises(); }),
    output(Family::probe_stretch, [](const Observed& o, int n, int) { return material_at(o, n).largest_stretch(); }),
    output(Family::probe_velocity, [](const Observed& o, int n, int axis) { return o.probes[n](o.body.state().v.col(axis)); }),
    output(Family::probe_acceleration, [](const Observed& o, int n, int axis) { return followed(o, n).acceleration[axis]; }),
    output(Family::probe_largest_velocity, [](const Observed& o, int n, int) { return followed(o, n).speed; }),
    output(Family::probe_largest_acceleration, [](const Observed& o, int n, int) { return followed(o, n).largest_acceleration; }),
    output(Family::probe_largest_von_mises, [](const Observed& o, int n, int) { return followed(o, n).von_mises; }),
    output(Family::sensor_force, [](const Observed& o, int n, int axis) { return o.body.readings().sensor(n).force[axis]; }),
    output(Family::sensor_torque, [](const Observed& o, int n, int axis) { return o.body.readings().sensor(n).torque[axis]; }),
    output(Family::sensor_area, [](const Observed& o, int n, int) { return o.body.readings().sensor(n).area; }),
    output(Family::sensor_pressure, [](const Observed& o, int n, int) { return o.body.readings().sensor(n).pressure; }),
    output(Family::sensor_peak_pressure, [](const Observed& o, int n, int) { return o.body.readings().sensor(n).peak; }),
    output(Family::sensor_taxel, [](const Observed& o, int n, int axis) { return o.body.readings().taxel(n)[axis]; }),
    output(Family::plane_reaction, [](const Observed& o, int q, int axis) { return o.body.readings().plane_reaction(q)[axis]; }),
    output(Family::plane_torque, [](const Observed& o, int q, int axis) { return o.body.readings().plane_torque(q)[axis]; }),
    output(Family::plane_centre, [](const Observed& o, int q, int axis) { return o.body.readings().plane_centre(q)[axis]; }),
    output(Family::plane_contacts, [](const Observed& o, int q, int) { return double(o.body.readings().plane_contacts(q)); }),
    output(Family::pin_reaction, [](const Observed& o, int a, int axis) { return o.body.readings().pin_reaction(a)[axis]; }),
    output(Family::pin_torque, [](const Observed& o, int a, int axis) { return o.body.readings().pin_torque(a)[axis]; }),
    output(Family::energy_kinetic, [](const Observed& o, int, int) { return o.body.readings().kinetic_energy(); }),
    output(Family::energy_elastic, [](const Observed& o, int, int) { return o.body.readings().elastic_energy(); }),
    output(Family::energy_gravity, [](const Observed& o, int, int) { return o.body.readings().gravity_energy(); }),
    output(Family::energy_dissipated, [](const Observed& o, int, int) { return o.body.readings().dissipated_energy(); }),
    output(Family::energy_work, [](const Observed& o, int, int) { return o.body.readings().work(); }),
    output(Family::solver_steps, [](const Observed& o, int, int) { return double(o.body.readings().steps()); }),
    output(Family::solver_rejected, [](const Observed& o, int, int) { return double(o.body.readings().rejected()); }),
    output(Family::solver_contacts_resolved, [](const Observed& o, int, int) { return double(o.body.readings().contacts_resolved()); }),
    output(
        Family::solver_stable_step, [](const Observed& o, int, int) { return o.body.readings().stable_step(); },
        [](const Observed&, int, int) { return 0.0; }),  // 0, because a stable step costs as much as a step and is not extrapolated
    output(Family::solver_folded_cells, [](const Observed& o, int, int) { return double(o.body.readings().folded_cells()); }),
    output(Family::solver_error_estimate, [](const Observed& o, int, int) { return o.estimate->value(); }),
    setting(Family::body_force, of_free<&FreeLoad::force>, of_free<&FreeLoad::force_rate>),
    setting(Family::body_torque, of_free<&FreeLoad::torque>, of_free<&FreeLoad::torque_rate>),
    setting(Family::start_velocity, of_plane<&PlaneMotion::velocity>),
    setting(Family::start_angular_velocity, of_plane<&PlaneMotion::angular_velocity>),
    setting(Family::body_mass, [](Settings& s, int k) { return &s.free[k].mass; }),
    output(
        Family::body_position, [](const Observed& o, int k, int axis) { return free_state(o, k).position[axis]; },
        [](const Observed& o, int k, int axis) { return free_state(o, k).velocity[axis]; }),
    output(Family::body_orientation, [](const Observed& o, int k, int c) { return free_state(o, k).orientation[c]; }),
    output(Family::body_velocity, [](const Observed& o, int k, int axis) { return free_state(o, k).velocity[axis]; }),
    output(Family::body_angular_velocity, [](const Observed& o, int k, int axis) { return o.body.angular_velocity(k)[axis]; }),
    output(Family::free_plane_torque, [](const Observed& o, int q, int axis) { return o.body.readings().plane_torque(q)[axis]; }),
    output(Family::free_pin_torque, [](const Observed& o, int a, int axis) { return o.body.readings().pin_torque(a)[axis]; }),
};

namespace {

constexpr bool every_family_is_bound() {
  for (std::size_t n = 0; n < family_count; ++n)
    if (bindings[n].family != families[n].family || bindings[n].is_output != (families[n].causality == Causality::output)) return false;
  return true;
}
static_assert(every_family_is_bound(), "bindings must have the families of variables.toml, in their order, outputs with their output");

}  // namespace

bool differenced(std::size_t row) { return bindings[row].is_output && families[row].type == Type::Real && !bindings[row].rate_output; }

const PartBinding& binding_of(Part part) { return part_bindings[std::size_t(part)]; }

}  // namespace softffd::fmi
