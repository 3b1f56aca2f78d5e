#include "variables/variables.hpp"

#include <cmath>
#include <set>

#include "check.hpp"
#include "small_scene.hpp"
#include "whole_scene.hpp"

using namespace whole_scene;
using softffd::Settings;
using softffd::Vec3;

TEST(every_family_has_variables_with_names_of_their_own) {
  const Scene scene;
  std::set<std::string> names;
  std::size_t all = 0;
  for (const FamilyInfo& info : present) {
    const int n = count(scene, info);
    CHECK(n > 0);
    all += n;
    for (int i = 0; i < n; ++i) names.insert(scene.variables.name(reference_of(info.family, i)));
  }
  CHECK(names.size() == all);
  for (const std::string& name : names) CHECK(name.find_first_of("{}") == name.npos);
}

TEST(names_tell_the_member_and_the_component) {
  const Scene scene;
  const auto name = [&](Family family, int index) { return scene.variables.name(reference_of(family, index)); };
  CHECK(name(Family::force, 4) == "force[1,1,0].y" && name(Family::velocity, 2) == "velocity[1,0,1].z");
  CHECK(name(Family::plane_point, 2) == "plane.lid.point.z" && name(Family::fixed_plane_point, 0) == "plane.ground.point.x");
  CHECK(name(Family::plane_friction, 1) == "plane.lid.friction" && name(Family::plane_contacts, 0) == "plane.ground.contacts");
  CHECK(name(Family::pin_orientation, 0) == "pin.hand.orientation.w" && name(Family::pin_reaction, 3) == "pin.hand.reaction.x");
  CHECK(name(Family::load, 1) == "load.push.y" && name(Family::probe, 0) == "probe.nose.x" && name(Family::mass, 0) == "mass");
  CHECK(name(Family::sensor_taxel, 4) == "sensor.sole.taxel[0,1].y" && name(Family::sensor_area, 0) == "sensor.sole.area");
}

TEST(flat_names_have_underscores_at_control_points) {
  const Scene scene(small_scene::Box{.side = 3}.text("flat_names\nforces 2 3\n"));
  CHECK(scene.variables.name(reference_of(Family::force, 4)) == "force_0_1_0_y");
  CHECK(scene.variables.name(reference_of(Family::position, 3 * 26)) == "position_2_2_2_x");
  CHECK(scene.variables.name(reference_of(Family::mass, 0)) == "mass");
}

TEST(every_settable_variable_takes_a_value_and_gives_it_back) {
  Scene scene;
  for (const FamilyInfo& info : present)
    for (int i = 0; settable(info) && i < count(scene, info); ++i) {
      const double value = info.family == Family::solver_method ? 3 : 0.5 + i;
      scene.set(reference_of(info.family, i), value, info.type);
      CHECK(scene.get(reference_of(info.family, i), info.type) == value);
    }
  scene.variables.reset();
  CHECK(scene.get(reference_of(Family::mass)) == 2 && scene.get(reference_of(Family::solver_method), Type::Integer) == 1);
  CHECK(scene.get(reference_of(Family::plane_point, 2)) == 9 && scene.get(reference_of(Family::plane_velocity, 2)) == -1);
  CHECK(scene.get(reference_of(Family::pin_position, 1)) == 1 && scene.get(reference_of(Family::pin_orientation)) == 1);
}

TEST(every_output_can_be_read_and_not_set) {
  Scene scene;
  for (const FamilyInfo& info : present) {
    if (settable(info)) continue;
    const fmi2ValueReference reference = reference_of(info.family);
    CHECK(std::isfinite(scene.get(reference, info.type)));
    CHECK(refusal([&] { scene.set(reference, 1, info.type); }) == scene.variables.name(reference) + ": cannot be set (it is an output)");
  }
  CHECK(scene.get(reference_of(Family::position, 3 * 7 + 2)) == 1.0);  // the hand holds it
  CHECK(scene.get(reference_of(Family::position, 3 * 5 + 2)) == 1.5 && scene.get(reference_of(Family::velocity, 0)) == 1);
  CHECK(scene.get(reference_of(Family::probe, 2)) > 1);
}

TEST(lists_of_the_same_length_one_after_the_other_are_told_apart) {
  Scene scene;
  const auto get = [&](Type type, std::vector<fmi2ValueReference> references) {
    std::vector<double> numbers(references.size(), NAN);
    scene.variables.get(type, references.data(), references.size(), numbers.data(), scene.body, &scene.estimate);
    return numbers;
  };
  const fmi2ValueReference x = reference_of(Family::position, 15), z = reference_of(Family::position, 17),
                           mass = reference_of(Family::mass);
  const fmi2ValueReference steps = reference_of(Family::solver_steps), none = reference_of(Family::position, 24);
  for (int times = 0; times < 2; ++times) {
    CHECK(get(Type::Real, {x, z, mass}) == std::vector<double>({1, 1.5, 2}));
    CHECK(get(Type::Real, {z, mass, x}) == std::vector<double>({1.5, 2, 1}));
    CHECK(get(Type::Integer, {steps, steps, steps}) == std::vector<double>(3, 0));
    CHECK(!refusal([&] { get(Type::Real, {z, mass, none}); }).empty() && !refusal([&] { get(Type::Integer, {z, mass, x}); }).empty());
    CHECK(get(Type::Real, {}).empty() && get(Type::Real, {z, mass, x}) == std::vector<double>({1.5, 2, 1}));
  }
  for (const fmi2ValueReference each : {reference_of(Family::load, 0), reference_of(Family::load, 2)}) {
    scene.set(each, 7);
    CHECK(scene.get(each) == 7);
  }
  CHECK(scene.get(reference_of(Family::load, 1)) == 0);
}

TEST(references_of_no_variable_are_refused) {
  Scene scene;
  for (const FamilyInfo& info : present) {
    const fmi2ValueReference beyond = reference_of(info.family, count(scene, info));
    const std::string wanted = "value reference " + std::to_string(beyond) + ": this scene has no such variable";
    CHECK(refusal([&] { scene.get(beyond, info.type); }) == wanted && refusal([&] { scene.set(beyond, 1, info.type); }) == wanted);
  }
  for (fmi2ValueReference reference : {0u, 0xffffffu, 127u << 24, 0x80000000u, 0xffffffffu})
    CHECK(!refusal([&] { scene.get(reference); }).empty());
}

TEST(a_call_for_another_type_is_refused) {
  Scene scene;
  for (const FamilyInfo& info : present) {
    const Type other = info.type == Type::Real ? Type::Integer : Type::Real;
    CHECK(refusal([&] { scene.get(reference_of(info.family), other); }).find(": is of type ") != std::string::npos);
    CHECK(refusal([&] { scene.set(reference_of(info.family), 1, other); }).find(": is of type ") != std::string::npos);
  }
}

TEST(values_out_of_range_are_refused_and_nothing_is_set) {
  Scene scene;
  for (const FamilyInfo& info : present) {
    if (!settable(info)) continue;
    const fmi2ValueReference references[] = {info.type == Type::Real ? reference_of(Family::gravity) : reference_of(Family::solver_method),
                                             reference_of(info.family)};
    std::vector<double> bad{NAN, INFINITY, -INFINITY};
    if (std::isfinite(info.min)) bad.push_back(std::nextafter(info.min, -1.0));
    if (std::isfinite(info.above)) bad.push_back(info.above);
    if (info.family == Family::solver_method) bad.insert(bad.end(), {0, method_count + 1});
    for (double value : bad) {
      const double before[] = {scene.get(references[0], info.type), scene.get(references[1], info.type)}, wanted[] = {3, value};
      const std::string said = refusal([&] { scene.variables.set(instantiated, info.type, references, 2, wanted); });
      CHECK(said.find(scene.variables.name(references[1]) + ": wanted ") == 0);
      CHECK(scene.get(references[0], info.type) == before[0] && scene.get(references[1], info.type) == before[1]);
    }
    if (std::isfinite(info.min)) CHECK(refusal([&] { scene.set(references[1], info.min, info.type); }).empty());
  }
}

TEST(what_may_be_set_when_follows_causality_and_variability) {
  Scene scene;
  for (const FamilyInfo& info : present) {
    if (!settable(info)) continue;
    const bool any_time = info.causality == Causality::input || info.variability == Variability::tunable;
    const auto said = [&](Phase phase) { return refusal([&] { scene.set(reference_of(info.family), 1, info.type, phase); }); };
    CHECK(said(instantiated).empty() && said(initializing).empty());
    CHECK(said(stepping) == (any_time ? "" : scene.variables.name(reference_of(info.family)) + ": cannot be set after initialization"));
  }
}

TEST(values_reach_their_places_in_the_settings) {
  Scene scene;
  double next = 1;
  for (const FamilyInfo& info : present)
    for (int i = 0; info.type == Type::Real && settable(info) && i < count(scene, info); ++i)
      scene.set(reference_of(info.family, i), next++);
  const auto value3 = [&](Family family, int member = 0) {
    Vec3 v;
    for (int c = 0; c < 3; ++c) v[c] = scene.get(reference_of(family, 3 * member + c));
    return v;
  };
  Settings& s = scene.body.settings;
  CHECK(scene.variables.changed() && scene.variables.apply(s) && !scene.variables.changed());
  CHECK(s.planes[0].point == value3(Family::fixed_plane_point) && s.planes[0].normal == value3(Family::fixed_plane_normal));
  CHECK(s.planes[0].velocity == value3(Family::fixed_plane_velocity));
  CHECK(s.planes[0].angular_velocity == value3(Family::fixed_plane_angular_velocity) && !s.planes[0].moved_by_input);
  CHECK(s.planes[1].point == value3(Family::plane_point) && s.planes[1].normal == value3(Family::plane_normal));
  CHECK(s.planes[1].velocity == value3(Family::plane_velocity) && s.planes[1].angular_velocity == value3(Family::plane_angular_velocity));
  CHECK(s.planes[1].moved_by_input && s.planes[1].friction == scene.get(reference_of(Family::plane_friction, 1)));
  CHECK(s.pins[1].position == value3(Family::pin_position) && s.pins[1].velocity == value3(Family::pin_velocity));
  CHECK(s.pins[1].angular_velocity == value3(Family::pin_angular_velocity));
  for (int c = 0; c < 4; ++c) CHECK(s.pins[1].orientation[c] == scene.get(reference_of(Family::pin_orientation, c)));
  CHECK(s.rotation == value3(Family::initial_rotation));
  const softffd::Definition start{.lattice = scene.body.lattice()};
  const softffd::PinMotion turned = softffd::start_pose(start, 0, Vec3::Zero(), s.rotation);  // the fixed one turns with the body
  CHECK(s.pins[0].position == turned.position && s.pins[0].orientation == turned.orientation && !turned.position.isZero());
  CHECK(s.gravity == value3(Family::gravity) && s.mass == scene.get(reference_of(Family::mass)));
  CHECK(s.stiffness.edge == scene.get(reference_of(Family::stiffness_edge)) && s.damping == scene.get(reference_of(Family::damping)));
  CHECK(s.internal_damping == scene.get(reference_of(Family::internal_damping)));
  CHECK(s.tolerance == scene.get(reference_of(Family::solver_tolerance)) && s.step == scene.get(reference_of(Family::solver_step)));
  const Vec3 load = value3(Family::load), own = value3(Family::force, 0), other = value3(Family::force, 1);
  for (int c = 0; c < 3; ++c) {
    CHECK((*s.force)(1, c) == load[c] / 2 && (*s.force)(2, c) == own[c] + load[c] / 2 && (*s.force)(3, c) == other[c]);
    CHECK((*s.force)(0, c) == 0);
  }
}

TEST(a_solid_has_poissons_ratio_and_what_its_probes_ask_for) {
  std::string records = "guid {g}\ncounts 4 4 4\nbasis patches\nmass";
  for (int p = 0; p < 64; ++p) records += " 1";
  records += "\nyoungs_modulus 2e5\npoissons_ratio 0.4\nprobe all 0.5 0.5 0.5\nprobe_outputs stress von_mises stretch\nprobe none 0 0 0\n";
  Scene scene(small_scene::with_first_line(records));
  const auto& settings = scene.body.settings;
  const fmi2ValueReference ratio = reference_of(Family::poissons_ratio);
  CHECK(scene.variables.name(ratio) == "poissons_ratio" && settings.poissons_ratio == 0.4);
  CHECK(scene.variables.name(reference_of(Family::probe_stress_xy)) == "probe.all.stress.xy");
  CHECK(scene.variables.name(reference_of(Family::probe_stretch, 1)).find("value reference") == 0);
  for (const Family family : {Family::probe_stress_xx, Family::probe_stress_yz, Family::probe_von_mises, Family::probe_stretch})
    CHECK_NEAR(scene.get(reference_of(family)), family == Family::probe_stretch ? 1 : 0, 1e-9);
  scene.set(ratio, 0.495, Type::Real, stepping);
  CHECK(scene.variables.apply(scene.body.settings) && settings.poissons_ratio == 0.495);
  CHECK(refusal([&] { scene.set(ratio, 0.6, Type::Real, stepping); }) == "poissons_ratio: wanted <= 0.495, got 0.6");
}

TEST(only_changes_of_the_material_ask_for_it_anew) {
  Scene scene;
  for (const FamilyInfo& info : present) {
    if (!settable(info)) continue;
    scene.set(reference_of(info.family), 1, info.type);
    CHECK(scene.variables.apply(scene.body.settings) == info.material);
  }
}

TEST(a_part_that_the_scene_has_not_has_no_variables) {
  const Scene bare(small_scene::Box{.side = 2}.text(""));
  for (const FamilyInfo& info : families) {
    const bool exists = info.part == Part::always || info.part == Part::stiffness || info.part == Part::positions;
    CHECK((bare.variables.name(reference_of(info.family)).find("value reference") != 0) == exists);
  }
}
