#include "matrix/stiffness_matrix.hpp"

namespace softffd {

namespace {

/// Adds only the blocks that couple points that are not pinned.
struct FreeBlocks final : BlockSink {
  FreeBlocks(const std::vector<bool>& pinned, LatticeMatrix& matrix) : pinned(pinned), matrix(matrix) {}
  void add(int p, int q, const Mat3& block) override {
    if (!pinned[p] && !pinned[q]) matrix.add_block(p, q, block);
  }
  const std::vector<bool>& pinned;
  LatticeMatrix& matrix;
};

}  // namespace

void assemble(const Body& body, const Points& x, const Linearisation& of, const Scalars& diagonal, LatticeMatrix& matrix) {
  matrix.clear();
  FreeBlocks sink(body.pinned, matrix);
  for (const auto& each : body.energies) each->add_blocks(x, of, sink);
  for (int p = 0; p < body.points(); ++p) matrix.add_block(p, p, Mat3((body.pinned[p] ? 1 : diagonal[p]) * Mat3::Identity()));
}

}  // namespace softffd
