/// Prints what the parts of a run cost in instructions, a line each: name, tab, count; before them compiler, tab, instruction set.
/// tests/support/instruction_counts.py compares them.
#include "instruction_counter.hpp"

#ifdef SOFTFFD_COUNTS_INSTRUCTIONS
#include <cstdio>
#include <memory>
#include <vector>

#include "embedding/deform.hpp"
#include "machine/instructions.hpp"
#include "soft_bodies.hpp"

using namespace softffd;

namespace {

#ifdef __clang__
constexpr const char* compiler = "clang++";
constexpr int major = __clang_major__;
#else
constexpr const char* compiler = "g++";
constexpr int major = __GNUC__;
#endif
constexpr const char* set[] = {"baseline", "avx2", "avx512"};
constexpr double h = 1e-4;
InstructionCounter counter;

void print(const char* name, std::int64_t count) { std::printf("%s\t%lld\n", name, static_cast<long long>(count)); }

/// One kilogram, some steps after its start.
struct Box {
  Box(Method method, const std::array<int, 3>& points, const Vec3& stretch, int planes, const std::vector<Vec3>& vertices = {})
      : body(definition(points, stretch, planes, vertices)) {
    body.settings.stiffness = {1e3, 1e3, 1e3};
    body.settings.method = method;
    body.settings.step = h;
    if (planes) body.settings.gravity = {0, 0, -9.81};
    for (PlaneMotion& plane : body.settings.planes) plane.friction = 0.4;
    body.initialize(0);
    go_on(16);
  }
  static Definition definition(const std::array<int, 3>& points, const Vec3& stretch, int planes, const std::vector<Vec3>& vertices) {
    Definition definition = one_kilogram(points, planes);
    definition.stretch = stretch;
    if (!vertices.empty()) definition.samples = std::make_shared<Samples>(Basis::bezier, definition.lattice, vertices);
    return definition;
  }
  void go_on(int steps) { body.advance(steps * h); }

  /// Of a communication step of this many internal steps.
  std::int64_t counted(int steps) {
    return counter.count([&] { go_on(steps); });
  }
  SoftBody body;
};

/// Of a body on three feet.
const std::vector<Vec3> feet{{0.2, 0.2, 0}, {0.8, 0.25, 0}, {0.5, 0.8, 0}, {0.5, 0.5, 1}};

std::int64_t of_vertices(int side, bool bspline) {
  constexpr int vertices = 64;
  const int counts[] = {side, side, side};
  const double origin[] = {0, 0, 0}, size[] = {1, 1, 1};
  std::vector<double> control(3 * side * side * side), rest(3 * vertices), moved(3 * vertices);
  for (std::size_t i = 0; i < control.size(); ++i) control[i] = double(i * 37 % 101) / 101;
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = double(i * 29 % 97) / 97;
  const auto deform = [&] {
    softffd_deform(origin, size, counts, bspline, 1, control.data(), vertices, rest.data(), vertices, moved.data());
  };
  deform();
  return counter.count(deform);
}

}  // namespace

int main() {
  std::printf("%s %d\t%s\n", compiler, major, set[static_cast<int>(kernels::instructions())]);
  Box bare(Method::leapfrog, {4, 4, 4}, {1.02, 1, 1}, 0), resting(Method::leapfrog, {4, 4, 4}, {1, 1, 1}, 1),
      standing(Method::leapfrog, {4, 4, 4}, {1, 1, 1}, 1, feet);
  Box damped(Method::leapfrog, {4, 4, 4}, {1, 1, 1}, 1, feet);
  damped.body.settings.internal_damping = 1e-4;
  damped.go_on(16);
  Box implicit(Method::backward_euler, {3, 3, 3}, {1.02, 1, 1}, 0);
  print("a communication step of one step", bare.counted(1));
  print("a communication step of 16 steps", bare.counted(16));
  print("8 steps with 16 points on a plane", resting.counted(8));
  print("8 steps with 3 vertices on a plane", standing.counted(8));
  print("8 damped steps with 3 vertices on a plane", damped.counted(8));
  print("an implicit step, 3 x 3 x 3", implicit.counted(1));
  print("64 vertices, 4 x 4 x 4, Bezier", of_vertices(4, false));
  print("64 vertices, 12 x 12 x 12, B-splines", of_vertices(12, true));
}
#else
int main() {}
#endif
