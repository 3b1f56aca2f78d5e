/// A test is a block `TEST(fact) { ... }`; CHECK prints what failed; main.cpp runs those of the files that it is given.
#pragma once
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

namespace check {

struct Test {
  const char *file, *name;
  void (*run)();
};
inline std::vector<Test> tests;
inline int failures = 0;

/// Whether whole grids of cases are wanted, as in the long run, and not representatives alone.
inline const bool thorough = std::getenv("SOFTFFD_THOROUGH") != nullptr;

/// The cases of a grid that are wanted: all, or every n-th.
template <class Case>
std::vector<Case> some(int every, const std::vector<Case>& cases) {
  std::vector<Case> chosen;
  for (std::size_t i = 0; i < cases.size(); i += thorough ? 1 : every) chosen.push_back(cases[i]);
  return chosen;
}

/// Each of the one with each of the other.
template <class A, class B>
std::vector<std::pair<A, B>> each_with(const std::vector<A>& some, const std::vector<B>& others) {
  std::vector<std::pair<A, B>> cases;
  for (const A& a : some)
    for (const B& b : others) cases.emplace_back(a, b);
  return cases;
}

struct Register {
  Register(const char* file, const char* name, void (*run)()) { tests.push_back({file, name, run}); }
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

#define TEST(name) TEST_OF(name, __COUNTER__)
#define TEST_OF(name, number) TEST_NUMBERED(name, number)  // several files of a room are compiled as one
#define TEST_NUMBERED(name, number) TEST_AS(name, name##_##number)
#define TEST_AS(name, function)                                                \
  static void function();                                                      \
  static const check::Register register_##function(__FILE__, #name, function); \
  static void function()
#define CHECK(condition) \
  if (!(condition)) check::report(__FILE__, __LINE__, #condition)
#define CHECK_NEAR(a, b, tolerance) check::near(a, b, tolerance, __FILE__, __LINE__, #a " == " #b)
