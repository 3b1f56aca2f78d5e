/// A test is a block `TEST(fact) { ... }`; CHECK prints what failed; main runs all and returns the number of failed checks.
#pragma once
#include <cmath>
#include <cstdio>
#include <vector>

namespace check {

struct Test {
  const char* name;
  void (*run)();
};
inline std::vector<Test> tests;
inline int failures = 0;

struct Register {
  Register(const char* name, void (*run)()) { tests.push_back({name, run}); }
};

inline void report(const char* file, int line, const char* text) {
  ++failures;
  std::printf("  %s:%d: %s\n", file, line, text);
}

inline bool near(double a, double b, double tolerance, const char* file, int line, const char* text) {
  if (std::abs(a - b) <= tolerance) return true;
  report(file, line, text);
  std::printf("    %.17g and %.17g differ by %.3g, allowed %.3g\n", a, b, std::abs(a - b), tolerance);
  return false;
}

}  // namespace check

#define TEST(name)                                           \
  static void name();                                        \
  static const check::Register register_##name(#name, name); \
  static void name()
#define CHECK(condition) \
  if (!(condition)) check::report(__FILE__, __LINE__, #condition)
#define CHECK_NEAR(a, b, tolerance) check::near(a, b, tolerance, __FILE__, __LINE__, #a " == " #b)

int main() {
  for (const check::Test& test : check::tests) {
    std::printf("%s\n", test.name);
    test.run();
  }
  std::printf("%zu tests, %d failed checks\n", check::tests.size(), check::failures);
  return check::failures > 0;
}
