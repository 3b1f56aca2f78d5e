/// Lattices too wide for matrices: implicit steps do not exist there, and nothing that a host or a state says makes them run.
#include <cstdlib>
#include <cstring>

#include "check.hpp"
#include "instance.hpp"
#include "small_scene.hpp"

using namespace softffd::fmi;
using softffd::Method;

namespace {

constexpr int side = 9, points = side * side * side;

/// Stiff, falling onto the ground: a narrow lattice takes implicit steps here.
Instance fresh(const std::string& parts = "") {
  const small_scene::Box box{.side = side, .mass = 1.0 / points, .stiffness = 3e5, .initial = "1 1 1 0 0 0.01 0 0 0 0 0 0"};
  const std::string ground = "damping 0.01\ngravity 0 0 -9.81\nplane ground fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.4\n";
  const fmi2CallbackFunctions callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
  return Instance(parse_scene(box.text(ground + parts)), Logger(callbacks, "wide", true));
}

void set_method(Instance& instance, double method) {
  const fmi2ValueReference reference = unsigned(Family::solver_method) << 24;
  instance.set(Type::Integer, &reference, 1, &method);
}

void start(Instance& instance) {
  instance.enter_initialization();
  instance.exit_initialization();
}

bool loads(Instance& instance, Bytes state, std::size_t word, std::uint64_t value) {
  std::memcpy(state.data() + 8 * word, &value, 8);
  try {
    instance.load_state(state);
  } catch (const StateError&) {
    return false;
  }
  return true;
}

}  // namespace

TEST(asking_for_the_implicit_method_is_an_error_that_says_why_and_what_else_there_is) {
  Instance instance = fresh();
  std::string said;
  try {
    set_method(instance, double(MethodValue::ros34pw2));
  } catch (const CallError& error) {
    said = error.what();
  }
  CHECK(said.find("solver.method: ros34pw2 is for lattices with at most 64 control points in a layer") == 0);
  CHECK(said.find("this one has 81; wanted auto (1) or an explicit method, e.g. dop853 (6)") != said.npos);
  set_method(instance, double(MethodValue::dop853));
}

TEST(a_scene_that_asks_for_it_is_refused) {
  bool refused = false;
  try {
    fresh("method 7\n");
  } catch (const SceneFileError&) {
    refused = true;
  }
  CHECK(refused);
}

TEST(a_stiff_body_in_contact_takes_explicit_steps) {
  Instance instance = fresh("solver\n");
  start(instance);
  for (int n = 0; n < 6; ++n) CHECK(instance.do_step(n * 0.01, 0.01) == fmi2OK);
  const fmi2ValueReference steps = unsigned(Family::solver_steps) << 24;
  double taken = 0;
  instance.get(Type::Integer, &steps, 1, &taken);
  CHECK(taken > 200);
}

TEST(a_state_that_names_a_method_with_matrices_is_refused) {
  Instance instance = fresh(), other = fresh();
  const Bytes before = instance.save_state();
  set_method(other, double(MethodValue::leapfrog));
  const Bytes changed = other.save_state();
  std::size_t asked = 0;
  while (std::memcmp(before.data() + 8 * asked, changed.data() + 8 * asked, 8) == 0) ++asked;
  CHECK(loads(instance, before, asked, std::bit_cast<std::uint64_t>(double(MethodValue::dop853))));
  CHECK(!loads(instance, before, asked, std::bit_cast<std::uint64_t>(double(MethodValue::ros34pw2))));
  // at the end of the state: the method of late, the favourite, two reasons, a flag, and two configurations of 3 numbers a point
  const std::size_t method = before.size() / 8 - 6 * points - 5;
  for (std::size_t word : {method, method + 1}) {
    CHECK(loads(instance, before, word, std::uint64_t(Method::dop853)));
    for (Method implicit : {Method::ros34pw2, Method::backward_euler, Method::floating_frame})
      CHECK(!loads(instance, before, word, std::uint64_t(implicit)));
  }
}
