/// Runs the tests of the files whose names without ending are given, and returns whether a check has failed; all where none is given.
#include <algorithm>
#include <filesystem>

#include "check.hpp"

int main(int count, char** names) {
  std::size_t run = 0;
  for (const check::Test& test : check::tests) {
    const std::string file = std::filesystem::path(test.file).stem().string();
    if (count > 1 && std::find(names + 1, names + count, file) == names + count) continue;
    std::printf("%s\n", test.name);
    test.run();
    ++run;
  }
  std::printf("%zu tests, %d failed checks\n", run, check::failures);
  return check::failures > 0;
}
