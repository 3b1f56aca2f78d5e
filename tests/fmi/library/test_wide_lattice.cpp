/// Lattices too wide for a factor: implicit steps solve by conjugate gradients there.
#include <cstdlib>

#include "check.hpp"
#include "instance/instance.hpp"
#include "small_scene.hpp"

using namespace softffd::fmi;
using softffd::Method;

namespace {

constexpr int side = 9, points = side * side * side;
const MethodValue implicit_methods[] = {MethodValue::ros34pw2, MethodValue::backward_euler};

/// Stiff, falling onto the ground if there is one.
SceneFile scene(const std::string& parts, bool free) {
  const small_scene::Box box{.side = side, .mass = 1.0 / points, .stiffness = 3e5, .initial = "1 1 1 0 0 0.01 0 0 0 0 0 0"};
  const std::string ground = free ? "" : "plane ground fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.4\n";
  return parse_scene(box.text("damping 0.01\ngravity 0 0 -9.81\n" + ground + parts));
}

Instance fresh(const std::string& parts, bool free = false) {
  const fmi2CallbackFunctions callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
  return Instance(scene(parts, free), Logger(callbacks, "wide", true));
}

void start(Instance& instance) {
  instance.enter_initialization();
  instance.exit_initialization();
}

}  // namespace

TEST(implicit_methods_take_a_stiff_body_down_in_few_steps) {
  for (const MethodValue method : implicit_methods) {
    Instance instance = fresh("solver\nmethod " + std::to_string(int(method)) + "\n");
    start(instance);
    for (int n = 0; n < 6; ++n) CHECK(instance.do_step(n * 0.01, 0.01) == fmi2OK);
    const fmi2ValueReference steps = unsigned(Family::solver_steps) << 24;
    double taken = 0;
    instance.get(Type::Integer, &steps, 1, &taken);
    CHECK(method == MethodValue::backward_euler ? taken < 20 : taken > 200);  // the other does not pass over the impact
  }
}

TEST(a_state_between_implicit_steps_goes_on_with_the_same_bits) {
  for (const MethodValue method : implicit_methods)
    for (const bool free : {true, false}) {
      const std::string parts = "method " + std::to_string(int(method)) + "\n";
      Instance one = fresh(parts, free), other = fresh(parts, free);
      start(one);
      start(other);
      for (int n = 0; n < 3; ++n) CHECK(one.do_step(n * 0.01, 0.01) == fmi2OK);
      other.load_state(one.save_state());
      for (int n = 3; n < 6; ++n)
        for (Instance* each : {&one, &other}) CHECK(each->do_step(n * 0.01, 0.01) == fmi2OK);
      CHECK(one.save_state() == other.save_state());
    }
}
