/// Broad phase: which samples of the surface a plane may meet. Searches are rare, and no sample is missed.
///
///      The gap of a sample is at least the least gap h_i of the control points (Samples::hull). If h_i is above 0, nothing is near.
///      Since the last search no sample has approached by more than the control point that approached most. The list still holds every
///      sample behind the plane while that approach is less than the `reserve` of the search.
///      A search fits h_i by an affine function a + b . X_i and a residual r_i. Then a + b . X_s + min r is a lower bound of the gap of s.
///      For a body that only turns and shears this bound is nearly the gap itself, so that few gaps are evaluated.
///
/// Surplus samples in a list change no result. They change the work for the list, and so the choice between methods. A communication step
/// therefore begins without lists, so that a stored state goes on with the same bits. Within the step lists are kept, also after a
/// rollback and for a motion integrated beside the run: a list is valid for all gaps of the control points that are near enough to those
/// of its search.
#pragma once
#include <algorithm>

#include "body/samples.hpp"

namespace softffd {

class SampleSearch {
 public:
  SampleSearch(const Samples& samples, int planes, double length);

  /// No list is known.
  void forget() { std::fill(planes_.begin(), planes_.end(), Known{}); }
  /// True if the list of plane q holds every sample that is behind or on the plane, at these gaps of the control points (points).
  bool covers(int q, const Scalars& of_points);
  /// Makes the list anew. way: how far a point may approach the plane in a step [m].
  void look(int q, const Scalars& of_points, double way);
  /// Returns the samples of the list, in ascending order.
  const std::vector<int>& near(int q) const { return planes_[q].away ? none_ : planes_[q].near; }
  /// True if the list is so long that evaluating each sample is to be avoided.
  bool is_long(int q) const;
  /// True if no sample of the list is further behind the plane than `slack` [m], because no control point that counts for one of them is.
  /// of_points: in any unit, which is also the unit of `slack`.
  bool in_front(int q, const Scalars& of_points, double slack);
  /// Number of searches so far.
  Count searches() const { return searches_; }

 private:
  struct Known {
    bool away = true;     ///< no sample is near
    double reserve = -1;  ///< samples with gaps below it are listed [m]; negative: no search yet
    Scalars gaps;         ///< of the control points at the search
    Scalars idle;         ///< (points) 0 for points that count for a listed sample, else infinite
    std::vector<int> near;
  };
  const Samples& samples_;
  double length_;
  Points rest_;
  Vec3 middle_, squares_;  ///< of the rest positions: mean, sums of squared distances from it per axis
  std::vector<Known> planes_;
  std::vector<int> none_;
  Scalars left_, room_;
  Count searches_ = 0;
};

}  // namespace softffd
