#include "resource/scene_file.hpp"

#include <string>

#include "check.hpp"
#include "small_scene.hpp"

using namespace softffd::fmi;
using small_scene::with_first_line;

namespace {

const std::string minimal = "guid {g}\ncounts 2 2 2\nmass 1 1 1 1 1 1 1 1\nstiffness 1 2 3\n";

bool refused(const std::string& text) {
  try {
    parse_scene(text);
  } catch (const SceneFileError&) {
    return true;
  }
  return false;
}

}  // namespace

TEST(a_scene_is_read_with_its_values) {
  const SceneFile scene = parse_scene(with_first_line(minimal + "gravity 0 0 -9.81\nplane floor fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.5\n"));
  CHECK(scene.guid == "{g}" && scene.definition.lattice.points() == 8 && scene.stiffness.body == 3);
  CHECK(scene.gravity && scene.gravity->z() == -9.81);
  CHECK(scene.planes.size() == 1 && scene.planes[0].friction == 0.5);
  CHECK(scene.stop_time == 1 && parse_scene(with_first_line(minimal + "stop_time 4\n")).stop_time == 4);
  CHECK(scene.definition.volume_stiffness == 0);
  CHECK(parse_scene(with_first_line(minimal + "volume_stiffness 9000\n")).definition.volume_stiffness == 9000);
}

TEST(the_basis_is_that_of_beziers_volume_unless_the_scene_says_otherwise) {
  CHECK(parse_scene(with_first_line(minimal)).basis == softffd::Basis::bezier);
  CHECK(parse_scene(with_first_line(minimal + "basis bspline\n")).basis == softffd::Basis::bspline);
}

TEST(the_finest_lattice_is_read) { CHECK(parse_scene(small_scene::Box{.side = 32}.text("")).definition.lattice.points() == 32 * 32 * 32); }

TEST(a_material_of_a_modulus_is_read) {
  const std::string base = "guid {g}\ncounts 2 2 2\nmass 1 1 1 1 1 1 1 1\nyoungs_modulus 2e5\n";
  const SceneFile scene = parse_scene(
      with_first_line(base + "internal_damping 0.001\nregion_youngs_modulus 4e5 0 1\nregion_internal_damping 0 2\nregion_stiffness 5 3\n"));
  CHECK(scene.definition.of_modulus && scene.modulus == 2e5 && scene.internal_damping == 0.001);
  const auto& regions = scene.definition.regions;
  CHECK(regions.size() == 3 && regions[0].modulus == 4e5 && regions[1].internal_damping == 0.0 && regions[2].stiffness == 5.0);
  CHECK(regions[0].points == std::vector<int>({0, 1}) && !regions[0].stiffness && !regions[1].modulus);
  CHECK(!parse_scene(with_first_line(minimal)).modulus && !parse_scene(with_first_line(minimal)).definition.of_modulus);
  CHECK(refused(with_first_line(base + "topology paper\n")));
}

TEST(how_the_body_and_its_pins_start_turned_is_read) {
  const SceneFile scene =
      parse_scene(with_first_line(minimal + "initial_rotation 0 0.5 0\npin p input 0 1\npin_start 1 2 3 0.6 0 0 0.8\n"));
  CHECK(scene.rotation == softffd::Vec3(0, 0.5, 0) && scene.pins[0].start->position == softffd::Vec3(1, 2, 3));
  CHECK(scene.pins[0].start->orientation == (std::array<double, 4>{0.6, 0, 0, 0.8}));
  CHECK(!parse_scene(with_first_line(minimal)).rotation && refused(with_first_line(minimal + "pin_start 1 2 3 1 0 0 0\n")));
}

TEST(what_gravity_pulls_at_is_read_where_it_is_not_the_mass) {
  CHECK(parse_scene(with_first_line(minimal + "weight 1 2 0 1 1 1 1 1\n")).definition.weight[1] == 2);
  CHECK(parse_scene(with_first_line(minimal)).definition.weight.empty());
  CHECK(refused(with_first_line(minimal + "weight 1 2\n")) && refused(with_first_line(minimal + "weight 1 1 1 1 1 1 1 -1\n")) &&
        refused(with_first_line(minimal + "weight 0 0 0 0 0 0 0 0\n")));
}

TEST(every_changed_byte_is_noticed) {
  const std::string good = with_first_line(minimal);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] ^= 1;
    CHECK(refused(bad));
  }
  for (std::size_t length = 0; length < good.size(); ++length) CHECK(refused(good.substr(0, length)));
}

TEST(faulty_records_are_refused) {
  for (const char* record : {"unknown 1\n",
                             "counts 2 2\n",
                             "counts 1 2 2\n",
                             "counts 2 2 99\n",
                             "size 1 0 1\n",
                             "gravity 0 0 nan\n",
                             "gravity 0 0 1e999\n",
                             "load a\n",
                             "load a 8\n",
                             "load a -1\n",
                             "load a 1.5\n",
                             "plane p moving 0\n",
                             "step -1\n",
                             "threads 0\n",
                             "threads 65\n",
                             "threads 1.5\n",
                             "stop_time 0\n",
                             "plane_inputs point.z\n",
                             "plane p fixed 0 0 0 0 0 1 0 0 0 0 0 0 0\nplane_inputs point.z\n",
                             "plane p input 0 0 0 0 0 1 0 0 0 0 0 0 0\nplane_inputs point\n",
                             "pin p input 0\npin_inputs point.z\n",
                             "pin_origin 0 0 0\n",
                             "pin p input 0\npin_origin 0 0\n",
                             "volume_stiffness 0\n",
                             "youngs_modulus 0\n",
                             "internal_damping -1\n",
                             "region_youngs_modulus -1 0\n",
                             "region_internal_damping 0 8\n",
                             "basis spline\n",
                             "guid a b\n",
                             "mass 1 1\n"})
    CHECK(refused(with_first_line(minimal + record)));
  CHECK(refused(with_first_line("guid {g}\ncounts 2 2 2\n")));
}
