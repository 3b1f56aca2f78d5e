/// Contact of the surface from a resources file to the component's variables and states.
#include "instances.hpp"

using namespace softffd::fmi;

namespace {

const small_scene::Box falling{.side = 4, .mass = 1.0 / 64, .stiffness = 2000, .initial = "1 1 1 0 0 -0.1 0.5 0 0 0.3 0.4 0"};
const std::string ground = "damping 0.3\ngravity 0 0 -9.81\nplane ground fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.4\nreactions\nsolver\n";
/// The corners of a pyramid in the box, 0.2 clear of its faces.
const std::string pyramid = "sample 0.2 0.2 0.2\nsample 0.8 0.2 0.2\nsample 0.2 0.8 0.2\nsample 0.8 0.8 0.2\nsample 0.5 0.5 0.8\n";

std::string refusal_of(const std::string& parts) {
  return refusal<SceneFileError>([&] { parse_scene(falling.text(parts)); });
}

}  // namespace

TEST(samples_of_a_scene_with_planes_are_taken) {
  const SceneFile scene = parse_scene(falling.text(ground + pyramid));
  CHECK(scene.definition.samples && scene.definition.samples->count() == 5);
  CHECK(scene.definition.samples->place(4) == softffd::Vec3(0.5, 0.5, 0.8));
  CHECK(!parse_scene(falling.text(ground)).definition.samples);
  CHECK(!parse_scene(falling.text(pyramid)).definition.samples);
}

TEST(what_does_not_go_with_samples_is_refused_by_name) {
  CHECK(refusal_of(ground + "sample 0.5 0.5 1.1\n").find("outside of the box") != std::string::npos);
  CHECK(refusal_of(ground + pyramid + "method 2\n").find("wanted auto, leapfrog") != std::string::npos);
  for (const int method : {1, 3, 4, 5, 6, 7, 8}) CHECK(refusal_of(ground + pyramid + "method " + std::to_string(method) + "\n").empty());
  CHECK(refusal_of(pyramid + "method 2\n").empty());  // nothing meets them
  CHECK(refusal_of(ground + "sample 0.5 0.5\n").find("a value is missing") != std::string::npos);
}

TEST(a_method_that_does_not_know_samples_cannot_be_set) {
  const auto instance = instance_of(falling.text(ground + pyramid));
  CHECK(refusal([&] { set_value(*instance, Family::solver_method, 3, Type::Integer); }).empty());
  const std::string why = refusal([&] { set_value(*instance, Family::solver_method, 2, Type::Integer); });
  CHECK(why.find("3 leapfrog") != std::string::npos && why.find("central_difference") == std::string::npos);
}
