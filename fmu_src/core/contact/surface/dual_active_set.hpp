/// The nearest state of the body that planes allow its samples, in the metric of the masses or of an implicit step's matrix
/// (step_delassus.hpp): minimise |y - y0|^2 subject to n_q . Q_s(y) >= b_qs.
///
/// Strictly convex, so y is one; solved exactly by the dual active set of Goldfarb & Idnani (1983), from the rows that were active before:
///
///      the rows' forces l >= 0 move gaps by l A; rows at hand are met exactly, the most violated other one is added:
///      t1: how far its force can grow before that of a row at hand is 0, which is dropped then
///      t2: how far until it is met itself, where it is appended
///
/// Everything is done in gaps above each plane, h_q = n_q . y - c_q at the control points: the rows' forces move them by scalar fields.
/// Crowded samples make A nearly singular, without harm: l >= 0 cannot cancel, and a Cholesky solution is backward stable. Which of them
/// carry the plane's force is not unique then; y and the planes' forces are.
#pragma once
#include "contact/surface/delassus.hpp"

namespace softffd {

/// A row that must be kept: the height of the sample above the plane >= bound.
struct Candidate {
  SurfaceRow row;
  double bound = 0;
  double gap = 0;  ///< result: height less bound at y, to rounding
};

/// Metric: Delassus, or what has its functions.
template <class Metric>
class DualActiveSetIn {
 public:
  explicit DualActiveSetIn(const Samples& samples) : delassus_(samples) {}

  Metric& delassus() { return delassus_; }
  const Metric& delassus() const { return delassus_; }
  const std::vector<SurfaceRow>& active() const { return delassus_.rows(); }
  const std::vector<double>& forces() const { return forces_; }  ///< of the active rows, sorted
  /// Did the last solution make rows active that were not?
  bool added() const { return added_; }
  /// Largest violation of a row that nothing free could mend, for all its points are pinned.
  double pinned_violation() const { return pinned_; }

  /// gaps: (planes) of y0, become those of y. candidates: sorted by row; the active ones must be among them. known: forces of the active
  /// rows that y0 has already, so that large forces that hold each other lose no digits; none: zero. Not finite: not found in so many
  /// steps.
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
  std::vector<double> forces_, known_, bounds_, wanted_;  ///< of the active rows: l, its part in y0, b, b less height at y0
  std::vector<double> scratch_;
  std::vector<GapFunction> begin_;  ///< of y0
  std::vector<GapFunction>* gap_functions_ = nullptr;
  std::vector<int> hot_;       ///< candidates that were violated most at the last full look
  std::vector<int> expected_;  ///< their samples
  std::vector<char> at_hand_;  ///< candidates: 1 active, 2 pinned
  std::vector<std::pair<double, int>> violated_;
  bool added_ = false;
  double pinned_ = 0;
};

using DualActiveSet = DualActiveSetIn<Delassus>;

}  // namespace softffd
