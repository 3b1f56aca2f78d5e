/// Whether the iterations of a Newton's method with a kept matrix come nearer to the solution, and what to do where they do not.
#pragma once
#include <algorithm>
#include <limits>

namespace softffd {

class Convergence {
 public:
  /// Takes the size of the next iteration's change; fresh: its matrix was made at this very state.
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
  /// What the next iterations will still change, by the last two [m]; infinite where there are no two.
  double left() const { return left_; }
  /// The kept matrix does not serve any more.
  bool needs_matrix() const { return needs_matrix_; }
  /// The next iterations are to be slow and safe.
  bool cautious() const { return cautious_; }
  /// The iterations do not come nearer: one that goes back is to be halved.
  bool circles() const { return circles_; }

 private:
  /// Ratio of a change to the one before that is progress, and with an old matrix at first.
  static constexpr double fair = 0.5, first_slowest = 0.1;
  /// A matrix of the state itself may be so much slower before a newer one is expected to be faster.
  static constexpr double no_faster = 1.5;
  /// Iterations without progress, those with it counted against them: what is too many, and what is too many for caution.
  static constexpr int patience = 2, despair = 6;

  double left_ = std::numeric_limits<double>::infinity(), last_ = 0, slowest_ = first_slowest;
  int stalled_ = 0;
  bool needs_matrix_ = false, cautious_ = false, circles_ = false;
};

}  // namespace softffd
