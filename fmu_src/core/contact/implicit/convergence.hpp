/// Whether the iterations of a Newton's method with a kept matrix approach the solution, and what to do where they do not.
#pragma once
#include <algorithm>
#include <limits>

namespace softffd {

class Convergence {
 public:
  /// Takes the size of the change in the next iteration [m]; fresh: its matrix was made at this very state.
  void add(double size, bool fresh) {
    const double ratio = last_ > 0 ? size / last_ : 0;
    left_ = last_ > 0 && ratio < fair ? size * ratio / (1 - ratio) : std::numeric_limits<double>::infinity();
    last_ = size;
    if (fresh && ratio < fair) slowest_ = std::max(slowest_, no_faster * ratio);
    needs_matrix_ = ratio > slowest_;
    stalled_ = ratio > fair ? stalled_ + 1 : std::max(0, stalled_ - 1);
    cautious_ = stalled_ > patience && stalled_ < despair;
    circles_ = stalled_ > patience;
    if (stalled_ == despair) stalled_ = 0;
  }
  /// What further iterations will still change, estimated from the last two [m]; infinite if there are no two, or they show no progress.
  double left() const { return left_; }
  /// True if the kept matrix does not serve any more.
  bool needs_matrix() const { return needs_matrix_; }
  /// True if the next iterations should be slow and safe.
  bool cautious() const { return cautious_; }
  /// True if the iterations do not approach the solution: a change that goes back should be halved.
  bool circles() const { return circles_; }

 private:
  /// Ratios of a change to the one before: below `fair` it is progress; above `first_slowest` the matrix is made anew, at first.
  static constexpr double fair = 0.5, first_slowest = 0.1;
  /// A newer matrix is expected to be faster if the ratio exceeds that of a fresh matrix by more than this factor.
  static constexpr double no_faster = 1.5;
  /// Iterations without progress less those with it. Above `patience` the next ones are cautious; at `despair` the count starts again.
  static constexpr int patience = 2, despair = 6;

  double left_ = std::numeric_limits<double>::infinity(), last_ = 0, slowest_ = first_slowest;
  int stalled_ = 0;
  bool needs_matrix_ = false, cautious_ = false, circles_ = false;
};

}  // namespace softffd
