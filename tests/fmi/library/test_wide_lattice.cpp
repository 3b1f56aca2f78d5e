/// Lattices too wide for a factor: implicit steps solve by conjugate gradients there.
#include "instances.hpp"

using namespace softffd::fmi;

namespace {

constexpr int side = 9, point_count = side * side * side;
const MethodValue implicit_methods[] = {MethodValue::ros34pw2, MethodValue::backward_euler};

/// Stiff, falling onto the ground if there is one.
std::unique_ptr<Instance> fallen(MethodValue method, bool free = false) {
  const small_scene::Box box{.side = side, .mass = 1.0 / point_count, .stiffness = 3e5, .initial = "1 1 1 0 0 0.01 0 0 0 0 0 0"};
  const std::string ground = free ? "" : "plane ground fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.4\n";
  auto instance =
      instance_of(box.text("damping 0.01\ngravity 0 0 -9.81\nsolver\n" + ground + "method " + std::to_string(int(method)) + "\n"));
  start(*instance);
  return instance;
}

}  // namespace

TEST(implicit_methods_take_a_stiff_body_down_in_few_steps) {
  for (const MethodValue method : implicit_methods) {
    const auto instance = fallen(method);
    run(*instance, 0, 6);
    const double taken = value_of(*instance, Family::solver_steps, Type::Integer);
    CHECK(method == MethodValue::backward_euler ? taken < 20 : taken > 200);  // the other does not pass over the impact
  }
}

TEST(a_saved_state_has_no_room_to_spare) {
  const auto state = fallen(MethodValue::leapfrog)->save_state();
  CHECK(state.capacity() == state.size());
}

TEST(a_state_between_implicit_steps_goes_on_with_the_same_bits) {
  for (const MethodValue method : implicit_methods)
    for (const bool free : {true, false}) {
      const auto one = fallen(method, free), other = fallen(method, free);
      run(*one, 0, 3);
      other->load_state(one->save_state());
      for (const auto& each : {one.get(), other.get()}) run(*each, 3, 6);
      CHECK(one->save_state() == other->save_state());
    }
}
