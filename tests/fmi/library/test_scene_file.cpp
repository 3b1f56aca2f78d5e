#include "resource/scene_file.hpp"

#include "instances.hpp"

using namespace softffd::fmi;
using small_scene::with_first_line;

namespace {

const std::string minimal = "guid {g}\ncounts 2 2 2\nmass 1 1 1 1 1 1 1 1\nstiffness 1 2 3\n";

/// Records behind those that every scene has.
SceneFile read(const std::string& records = "", const std::string& base = minimal) { return parse_scene(with_first_line(base + records)); }

bool refused_text(const std::string& text) {
  return !refusal<SceneFileError>([&] { parse_scene(text); }).empty();
}
bool refused(const std::string& records, const std::string& base = minimal) { return refused_text(with_first_line(base + records)); }

}  // namespace

TEST(a_scene_is_read_with_its_values) {
  const SceneFile scene = read("gravity 0 0 -9.81\nplane floor fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.5\n");
  CHECK(scene.guid == "{g}" && scene.definition.lattice.points() == 8 && scene.stiffness.body == 3);
  CHECK(scene.gravity && scene.gravity->z() == -9.81);
  CHECK(scene.planes.size() == 1 && scene.planes[0].friction == 0.5);
  CHECK(scene.stop_time == 1 && read("stop_time 4\n").stop_time == 4);
  CHECK(scene.definition.volume_stiffness == 0);
  CHECK(read("volume_stiffness 9000\n").definition.volume_stiffness == 9000);
}

TEST(the_basis_is_that_of_beziers_volume_unless_the_scene_says_otherwise) {
  CHECK(read().definition.sensed.basis == softffd::Basis::bezier);
  CHECK(read("basis bspline\n").definition.sensed.basis == softffd::Basis::bspline);
}

TEST(the_finest_lattice_is_read) { CHECK(parse_scene(small_scene::Box{.side = 32}.text("")).definition.lattice.points() == 32 * 32 * 32); }

TEST(a_material_of_a_modulus_is_read) {
  const std::string base = "guid {g}\ncounts 2 2 2\nmass 1 1 1 1 1 1 1 1\nyoungs_modulus 2e5\n";
  const SceneFile scene =
      read("internal_damping 0.001\nregion_youngs_modulus 4e5 0 1\nregion_internal_damping 0 2\nregion_stiffness 5 3\n", base);
  CHECK(scene.definition.of_modulus && scene.modulus == 2e5 && scene.internal_damping == 0.001);
  const auto& regions = scene.definition.regions;
  CHECK(regions.size() == 3 && regions[0].modulus == 4e5 && regions[1].internal_damping == 0.0 && regions[2].stiffness == 5.0);
  CHECK(regions[0].points == std::vector<int>({0, 1}) && !regions[0].stiffness && !regions[1].modulus);
  CHECK(!read().modulus && !read().definition.of_modulus);
  CHECK(refused("topology paper\n", base));
}

TEST(how_the_body_and_its_pins_start_turned_is_read) {
  const SceneFile scene = read("initial_rotation 0 0.5 0\npin p input 0 1\npin_start 1 2 3 0.6 0 0 0.8\n");
  CHECK(scene.rotation == softffd::Vec3(0, 0.5, 0) && scene.pins[0].start->position == softffd::Vec3(1, 2, 3));
  CHECK(scene.pins[0].start->orientation == (std::array<double, 4>{0.6, 0, 0, 0.8}));
  CHECK(!read().rotation && refused("pin_start 1 2 3 1 0 0 0\n"));
}

TEST(what_gravity_pulls_at_is_read_where_it_is_not_the_mass) {
  CHECK(read("weight 1 2 0 1 1 1 1 1\n").definition.weight[1] == 2);
  CHECK(read().definition.weight.empty());
  CHECK(refused("weight 1 2\n") && refused("weight 1 1 1 1 1 1 1 -1\n") && refused("weight 0 0 0 0 0 0 0 0\n"));
}

TEST(every_changed_byte_is_noticed) {
  const std::string good = with_first_line(minimal);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] ^= 1;
    CHECK(refused_text(bad));
  }
  for (std::size_t length = 0; length < good.size(); ++length) CHECK(refused_text(good.substr(0, length)));
}

TEST(faulty_records_are_refused) {
  const std::vector<std::string> short_ones{
      "unknown 1",         "counts 2 2", "counts 1 2 2",     "counts 2 2 99",      "size 1 0 1",       "gravity 0 0 nan",
      "gravity 0 0 1e999", "load a",     "load a 8",         "load a -1",          "load a 1.5",       "step -1",
      "threads 0",         "threads 65", "threads 1.5",      "stop_time 0",        "plane p moving 0", "basis spline",
      "guid a b",          "mass 1 1",   "pin_origin 0 0 0", "volume_stiffness 0", "youngs_modulus 0"};
  for (const std::string& record : short_ones) CHECK(refused(record + "\n"));
  for (const char* records :
       {"plane_inputs point.z\n", "plane p fixed 0 0 0 0 0 1 0 0 0 0 0 0 0\nplane_inputs point.z\n", "internal_damping -1\n",
        "plane p input 0 0 0 0 0 1 0 0 0 0 0 0 0\nplane_inputs point\n", "pin p input 0\npin_inputs point.z\n",
        "pin p input 0\npin_origin 0 0\n", "region_youngs_modulus -1 0\n", "region_internal_damping 0 8\n"})
    CHECK(refused(records));
  CHECK(refused("", "guid {g}\ncounts 2 2 2\n"));
}
