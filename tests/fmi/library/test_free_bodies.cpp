/// Free bodies from a resources file to the component's variables and states.
#include <cstring>

#include "instances.hpp"

namespace free_bodies {

using namespace softffd::fmi;

namespace {

const small_scene::Box cube{.side = 2, .mass = 0.25, .stiffness = 100, .initial = "1 1 1 0 0 0 0 0 0 0 0 0"};
const std::string surface = "gravity 0 0 -10\nsample 0.5 0.5 0.5\n";
const std::string ball = "plane ball fixed 0 0 50 0 0 1 1 0 3 0 0 4 0.4\nsolid 0.1 0\n", mass = "free 2 0.1 0.1 0.2 ";
const std::string hand = "pin hand fixed 1 2\npin_origin 0.5 0.5 0\n", its_mass = "pin_free 3 0.1 0.1 0.2 ";
const std::string loose = "0 0 0\n", guided = "0 0.6 0.8\n";

std::string refusal_of(const std::string& parts) {
  return refusal<SceneFileError>([&] { parse_scene(cube.text(surface + parts)); });
}
bool refused(const std::string& parts, const std::string& why) { return refusal_of(parts).find(why) != std::string::npos; }

std::unique_ptr<Instance> begun(const std::string& parts) {
  auto instance = instance_of(cube.text(surface + parts));
  start(*instance, 10);
  return instance;
}

}  // namespace

TEST(free_bodies_of_a_file_are_obstacles_and_then_pins) {
  const SceneFile scene = parse_scene(cube.text(surface + ball + mass + guided + hand + its_mass + loose));
  const auto& free = scene.definition.free;
  CHECK(free.size() == 2 && scene.planes[0].free == 0 && scene.pins[0].free == 1);
  CHECK(free[0].plane == 0 && free[0].pin == -1 && free[0].mass == 2 && free[0].guided() && free[0].guide[2] == 0.8);
  CHECK(free[1].plane == -1 && free[1].pin == 0 && free[1].mass == 3 && !free[1].guided() && free[1].inertia[2] == 0.2);
}

TEST(what_makes_no_free_body_is_refused) {
  CHECK(refused(mass + loose, "nothing before it that may be free"));
  CHECK(refused(ball + mass + loose + mass + loose, "nothing before it that may be free"));
  CHECK(refused("plane ball input 0 0 50 0 0 1 0 0 0 0 0 0 0.4\nsolid 0.1 0\n" + mass + loose, "nothing before it that may be free"));
  CHECK(refused("plane a fixed 0 0 -50 0 0 1 0 0 0 0 0 0 0.4\n" + mass + loose, "a plane is not free"));
  CHECK(refused(ball + mass + "0 0 0.5\n", "no unit vector"));
  CHECK(refused(ball + "free 0 1 1 1 0 0 0\n", "above 0"));
  CHECK(refused(its_mass + loose, "nothing before it that may be free"));
  CHECK(refused(hand + its_mass + loose + ball + mass + loose, "a free obstacle comes after a pin"));
  for (const int method : {2, 4, 5, 6, 7, 8})
    CHECK(refused(hand + its_mass + loose + "method " + std::to_string(method) + "\n", "wanted auto, leapfrog or sdirk2"));
  for (const int method : {1, 3, 9}) CHECK(refusal_of(hand + its_mass + loose + "method " + std::to_string(method) + "\n").empty());
}

TEST(the_derivative_of_a_position_is_the_velocity) {
  const auto instance = begun(ball + mass + loose);
  run(*instance, 0, 1);
  const fmi2ValueReference position = reference_of(Family::body_position, 2), velocity = reference_of(Family::body_velocity, 2);
  const fmi2Integer order = 1;
  double rate = 0;
  instance->get_output_derivatives(&position, 1, &order, &rate);
  CHECK(rate == value_of(*instance, Family::body_velocity, Type::Real, 2));
  instance->get_output_derivatives(&velocity, 1, &order, &rate);
  CHECK_NEAR(rate, -10, 1e-10);
}

TEST(a_free_body_without_an_axis_does_not_start) {
  const auto instance = instance_of(cube.text(surface + ball + mass + loose));
  instance->setup_experiment(0, 0, 10);
  instance->enter_initialization();
  const fmi2ValueReference normal = reference_of(Family::fixed_plane_normal, 2);
  const double none = 0;
  instance->set(Type::Real, &normal, 1, &none);
  CHECK(!refusal([&] { instance->exit_initialization(); }).empty());
}

TEST(an_orientation_that_is_no_unit_quaternion_is_no_state) {
  const auto one = begun(ball + mass + loose);
  run(*one, 0, 10);
  Bytes damaged = one->save_state();
  const double scalar = value_of(*one, Family::body_orientation), none = 5;
  std::size_t at = 0;
  while (at < damaged.size() && std::memcmp(&damaged[at], &scalar, sizeof scalar) != 0) at += sizeof scalar;
  CHECK(at < damaged.size());
  std::memcpy(&damaged[at], &none, sizeof none);
  CHECK(refusal<StateError>([&] { one->load_state(damaged); }).find("no run produces") != std::string::npos);
}

}  // namespace free_bodies
