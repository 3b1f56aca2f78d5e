/// Which samples of the surface a plane may meet: seldom looked for, never missed.
///
///      a sample's height is at least the least height h_i of the control points (Samples::hull): where that is above the plane, nothing
///      is near;
///      since the last search no sample has come nearer than the control point that came most, so that its list still holds every
///      sample behind the plane while that is less than the `reserve` the search was made with;
///      a search fits h_i by an affine function a + b . X_i and a rest r_i; a + b . X_s + min r is a lower bound of the height of s, nearly
///      the height itself of a body that only turns and shears: few gaps are weighed.
///
/// What is in a list beyond that changes no result, but what the list takes, which counts as work and by that decides between methods: a
/// communication step begins without lists, so that a stored state goes on with the same bits. Within one they stay, also for steps that
/// are taken back and for a motion beside the run's: a list holds at any gaps of the control points that are near enough to those of its
/// search.
#pragma once
#include <algorithm>

#include "body/samples.hpp"

namespace softffd {

class SampleSearch {
 public:
  SampleSearch(const Samples& samples, int planes, double length);

  /// No list is known.
  void forget() { std::fill(planes_.begin(), planes_.end(), Known{}); }
  /// Does the list of plane q hold every sample that is behind it, or touches it, at these gaps of the control points (points)?
  bool covers(int q, const Scalars& of_points);
  /// Makes the list anew. way: how far a point may come nearer in a step [m].
  void look(int q, const Scalars& of_points, double way);
  /// In ascending order.
  const std::vector<int>& near(int q) const { return planes_[q].away ? none_ : planes_[q].near; }
  /// Are there so many that a look at each is to be avoided?
  bool is_long(int q) const;
  /// Is none of them further behind than this, because no control point is that counts for any of them? [m] of_points: in any unit.
  bool in_front(int q, const Scalars& of_points, double slack);
  /// Numbers of the searches so far.
  Count searches() const { return searches_; }

 private:
  struct Known {
    bool away = true;     ///< nothing is near
    double reserve = -1;  ///< [m]; negative: no search yet
    Scalars gaps;         ///< at the search
    Scalars idle;         ///< (points) infinite for those that count for none of these:
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
