/// The weights of a few samples side by side, for what is asked of all of them at once: where the lattice's points all count at each
/// sample, in one loop over the points that reads them once for some samples.
#pragma once
#include "contact/surface/delassus.hpp"

namespace softffd {

class SampleRows {
 public:
  explicit SampleRows(const Samples& samples) : samples_(samples) {}

  /// The samples of these rows from now on.
  void set(const std::vector<SurfaceRow>& rows);
  /// Of each Q_s of x; and of a value of each point, (points).
  void at(const Points& x, std::vector<Vec3>& out) const;
  void at(const Scalars& values, std::vector<double>& out) const;

 private:
  const Samples& samples_;
  struct Known {
    std::vector<SurfaceRow> rows;
    Scalars weights;   ///< (rows, points), where all points count
    PointRange range;  ///< of those with any weight
  };
  Known now_, before_;  ///< two sets of rows may take turns
};

}  // namespace softffd
