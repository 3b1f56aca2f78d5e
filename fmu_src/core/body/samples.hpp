/// Samples of the object's surface: points of the body that meet obstacles, if the control points of the lattice are not the surface.
///
/// A sample s is at X_s at rest and at Q_s(x) = sum_i W_si x_i in the deformed body. The weights are products of one factor per axis, sum
/// to one and reproduce positions: sum_i W_si X_i = X_s. The gap function of a plane is therefore linear too: the gap of a sample is Q_s
/// of the gaps of the points. If no weight is negative, the gap is at least the smallest gap of the points. The nodes of a solid have
/// negative weights; the gaps of the solid's control points bound those of the samples (`hull`).
#pragma once
#include <array>
#include <vector>

#include "model/basis.hpp"

namespace softffd {

/// Control points from `begin` to before `end`.
struct PointRange {
  int begin = 0, end = 0;
  bool operator==(const PointRange&) const = default;
};

class Samples {
 public:
  /// places: positions at rest [m], in the box of the lattice.
  Samples(Basis basis, const Lattice& lattice, const std::vector<Vec3>& places);

  /// Makes each point of the lattice a sample of weight 1.
  explicit Samples(const Lattice& lattice);

  const Lattice& lattice() const { return lattice_; }
  int count() const { return int(places_.size()); }
  /// Adds samples without control points: they do not belong to the object, but meet what the samples of the object meet.
  void add_idle(int number);
  int all() const { return int(first_.size()); }  ///< number of samples, the added ones included
  bool of_object(int s) const { return s < count(); }
  const Vec3& place(int s) const { return places_[s]; }
  /// Returns the number of control points that support a sample, those of weight 0 included.
  int support() const { return width_[0] * width_[1] * width_[2]; }

  /// True if weights may be negative.
  bool of_nodes() const { return lattice_.lobatto && support() > 1; }
  /// Returns numbers of which those at the samples are means: the numbers of the points (points), or for nodes those of control points, in
  /// `room`.
  const Scalars& hull(const Scalars& values, Scalars& room) const;
  const Points& hull(const Points& values, Points& room) const;

  /// Returns Q_s of one value per control point, (points).
  double at(int s, const double* values) const;
  Vec3 at(int s, const Points& x) const;

  /// out = W_si scale_i for the points that support s, (support).
  void weights(int s, const Scalars& scale, double* out) const;
  /// Returns a range of whole blocks of eight points outside of which these weights, (points) for each sample, are 0 for all samples.
  static PointRange range(const double* weights, int samples, int points);
  /// Returns the sum of W_ti times the output of `weights` for s.
  double product(int t, int s, const double* of_s) const;
  /// values_i = value for the points of nonzero weight; for nodes, for all points of the sample's patch.
  void mark(int s, double value, double* values) const;
  /// values_i += factor of_s_i for the points that support s.
  void add(int s, double factor, const double* of_s, double* values) const;
  void add(int s, const Vec3& factor, const double* of_s, Points& values) const;

 private:
  template <int columns>
  void at(int s, const double* values, std::ptrdiff_t column, double* sums) const;
  void add(int s, const double* factor, const double* of_s, double* values, int columns, std::ptrdiff_t column) const;
  /// Returns the index of the first point that supports s.
  int begin(int s) const { return first_[s][0] + counts_[0] * (first_[s][1] + counts_[1] * first_[s][2]); }
  const double* factors(int s) const { return &factors_[std::size_t(s) * (width_[0] + width_[1] + width_[2])]; }

  Lattice lattice_;
  std::array<int, 3> counts_, width_;      ///< per axis: control points of the lattice, and control points that support a sample
  bool fours_;                             ///< four points support a sample on every axis
  std::vector<Vec3> places_;               ///< positions at rest [m]
  std::vector<std::array<int, 3>> first_;  ///< first point that supports a sample, per axis
  std::vector<double> factors_;            ///< weights of each sample along x, y and z
};

}  // namespace softffd
