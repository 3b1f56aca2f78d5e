/// The springs of blocks of eight points; each kind of block is stored once. In every lattice most blocks have the same springs as others,
/// number by number, and share them. A lattice of 32 x 32 x 32 points has some 200 kinds among 4096 blocks, which stay in the caches.
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
  using Kind = std::array<Material, directions.size()>;  ///< springs that begin at the block's points

  explicit SpringKinds(int blocks);
  /// Removes the kinds of all blocks. Calls of `add` afterwards allocate no memory.
  void clear();
  /// Sets the kind of the next block.
  void add(const Kind& kind);

  const Material* of(int block) const { return kinds_[of_block_[block]].data(); }
  int different() const { return int(kinds_.size()); }

 private:
  std::vector<Kind> kinds_;    ///< the different kinds
  std::vector<int> of_block_;  ///< (blocks) index of a block's kind in kinds_
  std::vector<int> places_;    ///< indices in kinds_, by hash; the next free place if one is taken
};

}  // namespace softffd
