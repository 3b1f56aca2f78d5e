/// The weights of a few samples side by side, for quantities that are wanted at all of these samples at once. If all points of the
/// lattice count at each sample, one loop over the points reads them once for several samples.
#pragma once
#include "contact/surface/delassus.hpp"

namespace softffd {

class SampleRows {
 public:
  explicit SampleRows(const Samples& samples) : samples_(samples) {}

  /// Sets the rows whose samples are evaluated from now on.
  void set(const std::vector<SurfaceRow>& rows);
  /// Computes Q_s of x for the sample of each row; or of one value per point, (points).
  void at(const Points& x, std::vector<Vec3>& out) const;
  void at(const Scalars& values, std::vector<double>& out) const;

 private:
  const Samples& samples_;
  struct Known {
    std::vector<SurfaceRow> rows;
    Scalars weights;   ///< (rows, points), if all points count at each sample; else empty
    PointRange range;  ///< contains all points with a weight other than 0
  };
  Known now_, before_;  ///< kept because two sets of rows may take turns
};

}  // namespace softffd
