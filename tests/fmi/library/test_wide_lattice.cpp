/// Lattices too wide for matrices: implicit steps do not exist there, and nothing that a host or a state says makes them run.
#include <cstdlib>
#include <cstring>

#include "check.hpp"
#include "instance/instance.hpp"
#include "small_scene.hpp"

using namespace softffd::fmi;
using softffd::Method;

namespace {

constexpr int side = 9, points = side * side * side;
const std::pair<MethodValue, std::string> implicit_methods[] = {{MethodValue::ros34pw2, "ros34pw2"},
                                                                {MethodValue::backward_euler, "backward_euler"}};

/// Stiff, falling onto the ground: a narrow lattice takes implicit steps here.
SceneFile scene(const std::string& parts = "") {
  const small_scene::Box box{.side = side, .mass = 1.0 / points, .stiffness = 3e5, .initial = "1 1 1 0 0 0.01 0 0 0 0 0 0"};
  const std::string ground = "damping 0.01\ngravity 0 0 -9.81\nplane ground fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.4\n";
  return parse_scene(box.text(ground + parts));
}

Instance fresh(const std::string& parts = "") {
  const fmi2CallbackFunctions callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
  return Instance(scene(parts), Logger(callbacks, "wide", true));
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

/// First word in which two states differ.
std::size_t first_difference(const Bytes& one, const Bytes& other) {
  std::size_t word = 0;
  while (std::memcmp(one.data() + 8 * word, other.data() + 8 * word, 8) == 0) ++word;
  return word;
}

/// Words from there to the end of a state in which the run names a method; the run stands last.
std::size_t words_to_the_end(Method& (*named)(softffd::Run&)) {
  const auto bytes = [&](Method method) {
    softffd::Run run = softffd::SoftBody(scene().definition).run();
    named(run) = method;
    Bytes bytes;
    StateWriter writer(bytes);
    pass(writer, run);
    return bytes;
  };
  const Bytes one = bytes(Method::leapfrog), other = bytes(Method::bm4);
  return one.size() / 8 - first_difference(one, other);
}

}  // namespace

TEST(asking_for_an_implicit_method_is_an_error_that_says_why_and_what_else_there_is) {
  Instance instance = fresh();
  for (const auto& [method, name] : implicit_methods) {
    std::string said;
    try {
      set_method(instance, double(method));
    } catch (const CallError& error) {
      said = error.what();
    }
    CHECK(said.find("solver.method: " + name + " is for lattices with at most 64 control points in a layer") == 0);
    CHECK(said.find("this one has 81; wanted auto (1) or an explicit method, e.g. dop853 (6)") != said.npos);
  }
  set_method(instance, double(MethodValue::dop853));
}

TEST(a_scene_that_asks_for_one_is_refused) {
  for (const auto& [method, name] : implicit_methods) {
    std::string said;
    try {
      fresh("method " + std::to_string(int(method)) + "\n");
    } catch (const SceneFileError& error) {
      said = error.what();
    }
    CHECK(said.find("the lattice is too wide for the method " + name) != said.npos);
  }
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
  const std::size_t asked = first_difference(before, changed);
  CHECK(loads(instance, before, asked, std::bit_cast<std::uint64_t>(double(MethodValue::dop853))));
  CHECK(!loads(instance, before, asked, std::bit_cast<std::uint64_t>(double(MethodValue::ros34pw2))));
  const std::size_t of_late = words_to_the_end([](softffd::Run& run) -> Method& { return run.course.method; });
  const std::size_t raced = words_to_the_end([](softffd::Run& run) -> Method& { return run.course.race.winner; });
  for (std::size_t left : {of_late, raced}) {
    const std::size_t word = before.size() / 8 - left;
    CHECK(loads(instance, before, word, std::uint64_t(Method::dop853)));
    for (Method implicit : {Method::ros34pw2, Method::backward_euler, Method::floating_frame})
      CHECK(!loads(instance, before, word, std::uint64_t(implicit)));
  }
}
