/// What the springs of eight points are, of every lattice little: most blocks of points have the springs of others, number by number, and
/// share them. A lattice of 32 x 32 x 32 points has some 200 kinds of blocks among its 4096, which stay in the caches.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/lattice.hpp"

namespace softffd {

class SpringKinds {
 public:
  static constexpr int lanes = 8;
  struct alignas(64) Material {
    double stiffness[lanes] = {}, rest_length[lanes] = {};
  };
  using Kind = std::array<Material, directions.size()>;  ///< of the springs that begin at the block's points

  explicit SpringKinds(int blocks);
  /// No block has a kind any more. What follows asks for no memory.
  void clear();
  /// The next block's.
  void add(const Kind& kind);

  const Material* of(int block) const { return kinds_[of_block_[block]].data(); }
  int different() const { return int(kinds_.size()); }

 private:
  std::vector<Kind> kinds_;    ///< each once
  std::vector<int> of_block_;  ///< its place in kinds_
  std::vector<int> places_;    ///< in kinds_, by hash; the next free one where that is taken
};

}  // namespace softffd
