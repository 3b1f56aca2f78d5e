/// For two, four and eight consecutive points: the directions in which any spring has an end at these points, one bit each. Loops with
/// registers of any of these sizes therefore need a single look-up.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

namespace softffd {

class SpringEnds {
 public:
  /// points: a multiple of eight.
  explicit SpringEnds(int points) {
    for (std::size_t i = 0; i < of_.size(); ++i) of_[i].resize(points / sizes[i]);
  }
  void clear() {
    for (std::vector<unsigned>& bits : of_) std::fill(bits.begin(), bits.end(), 0u);
  }
  void add(int point, unsigned direction) {
    for (std::size_t i = 0; i < of_.size(); ++i) of_[i][point / sizes[i]] |= direction;
  }
  /// Returns the directions for the n points from p on; p is a multiple of n.
  template <int n>
  unsigned at(int p) const {
    static_assert(n == 2 || n == 4 || n == 8);
    return of_[n / 4][p / n];
  }

 private:
  static constexpr std::array<int, 3> sizes{2, 4, 8};
  std::array<std::vector<unsigned>, 3> of_;
};

}  // namespace softffd
