// Faults on purpose, one for each sanitizer: a net that lets them through would let everything through.
#include <cstdlib>
#include <limits>
#include <memory>

extern "C" __attribute__((visibility("default"))) int fault(int number) {
  int const volatile given = number;
  if (given == 1) {  // one past the end of what was allocated
    std::unique_ptr<int[]> const numbers{new int[4]{}};
    return numbers[static_cast<std::size_t>(given) + 3];
  }
  if (given == 2) return std::numeric_limits<int>::max() - 1 + given;  // overflows
  return 0;
}

int main(int count, char** arguments) { return count > 1 ? fault(std::atoi(arguments[1])) : 0; }
