/// Finds the state y of the body nearest to y0 in which no sample is behind a plane, in the metric of the masses or of the matrix of an
/// implicit step (step_delassus.hpp): minimise |y - y0|^2 subject to n_q . Q_s(y) >= b_qs.
///
/// The problem is strictly convex, so y is unique. The dual active set method of Goldfarb & Idnani (1983) solves it exactly, with the rows
/// that were active before as the warm start:
///
///      the forces l >= 0 of the rows move the gaps by l A; active rows are met exactly; the most violated other row is added:
///      t1: how far its force can grow before the force of an active row becomes 0, which is dropped then
///      t2: how far its force can grow until the row itself is met, and is appended
///
/// All computations use gaps above each plane, h_q = n_q . y - c_q at the control points, which the forces of rows change by scalar fields.
/// Samples close to each other make A nearly singular. This does no harm: l >= 0 cannot cancel, and a Cholesky solution is backward stable.
/// It is then not unique which of the samples carry the force of the plane, but y and the forces of the planes are unique.
#pragma once
#include "contact/surface/delassus.hpp"

namespace softffd {

/// A contact constraint to be satisfied: the height of the sample above the plane must be at least `bound` [m].
struct Candidate {
  SurfaceRow row;
  double bound = 0;
  double gap = 0;  ///< result: height at y less `bound`, to rounding
};

/// Metric: Delassus, or a class with the same functions.
template <class Metric>
class DualActiveSetIn {
 public:
  explicit DualActiveSetIn(const Samples& samples) : delassus_(samples) {}

  Metric& delassus() { return delassus_; }
  const Metric& delassus() const { return delassus_; }
  const std::vector<SurfaceRow>& active() const { return delassus_.rows(); }
  const std::vector<double>& forces() const { return forces_; }  ///< of the active rows, sorted
  /// True if the last solution made rows active that were not active before.
  bool added() const { return added_; }
  /// Returns the largest violation among rows that no force can satisfy, because all their points are pinned.
  double pinned_violation() const { return pinned_; }

  /// Finds y. gaps: (planes) of y0, become those of y. candidates: sorted by row, must contain the active rows. known: forces of the active
  /// rows that y0 contains already, so that large forces in mutual balance lose no digits; empty: zero. Returns not_finite if the
  /// solution is not found within the allowed steps and operations.
  StepStatus solve(std::vector<Candidate>& candidates, std::vector<GapFunction>& gaps, double tolerance,
                   const std::vector<double>& known = {});

 private:
  void warm();
  void leave(int row, typename Metric::Column* column = nullptr);
  void find_wanted();
  void find_forces();
  void sort(const std::vector<Candidate>& candidates);
  void spread();
  bool refine(const std::vector<Candidate>& candidates, double tolerance);
  int most_violated(std::vector<Candidate>& candidates, double tolerance);
  StepStatus add(const std::vector<Candidate>& candidates, int chosen);
  void renew_forces();
  double height(const SurfaceRow& row, const std::vector<GapFunction>& gaps) const {
    return gaps[row.plane].at(delassus_.samples(), row.sample);
  }

  Metric delassus_;
  typename Metric::Column column_;
  std::vector<double> forces_, known_, bounds_, wanted_;  ///< of the active rows: l, part of l in y0, b, b less height at y0
  std::vector<double> scratch_;
  std::vector<GapFunction> begin_;  ///< gaps of y0
  std::vector<GapFunction>* gap_functions_ = nullptr;
  std::vector<int> hot_;       ///< candidates most violated when all were last evaluated
  std::vector<int> expected_;  ///< samples of the candidates hot_
  std::vector<char> at_hand_;  ///< (candidates) 1: active, 2: pinned
  std::vector<std::pair<double, int>> violated_;
  bool added_ = false;
  double pinned_ = 0;
};

using DualActiveSet = DualActiveSetIn<Delassus>;

}  // namespace softffd
