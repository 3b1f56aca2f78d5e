/// Samples of the object's own surface: points of the body by which obstacles are met, where the control points of the lattice are not it.
///
/// A sample s is at the place X_s at rest and at Q_s(x) = sum_i W_si x_i of the deformed body. The weights are products of one factor per
/// axis, sum to one and reproduce places: sum_i W_si X_i = X_s. Gaps above a plane are therefore linear too: the gap of a sample is Q_s of
/// the gaps of the points, at least the smallest of them where no weight is negative. Nodes of a solid have negative ones; the gaps of its
/// control points bound those of the samples (`hull`).
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
  /// places: at rest [m], in the box of the lattice.
  Samples(Basis basis, const Lattice& lattice, const std::vector<Vec3>& places);

  /// The points of the lattice themselves, each of weight 1.
  explicit Samples(const Lattice& lattice);

  const Lattice& lattice() const { return lattice_; }
  int count() const { return int(places_.size()); }
  /// Adds samples at which no control point counts: of what is not the object, but meets what its samples meet.
  void add_idle(int number);
  int all() const { return int(first_.size()); }  ///< those among them
  bool of_object(int s) const { return s < count(); }
  const Vec3& place(int s) const { return places_[s]; }
  /// Number of control points that count at a sample, those of weight 0 among them.
  int support() const { return width_[0] * width_[1] * width_[2]; }

  /// Whether weights may be negative.
  bool of_nodes() const { return lattice_.lobatto && support() > 1; }
  /// Numbers of which those at the samples are means: those of the points (points), or, of nodes, of control points, in `room`.
  const Scalars& hull(const Scalars& values, Scalars& room) const;
  const Points& hull(const Points& values, Points& room) const;

  /// Q_s of a value of each control point, (points).
  double at(int s, const double* values) const;
  Vec3 at(int s, const Points& x) const;

  /// out = W_si scale_i of the points that count at s, (support).
  void weights(int s, const Scalars& scale, double* out) const;
  /// Points by eights of which these weights, (points) each, are not 0 for some sample; all others are.
  static PointRange range(const double* weights, int samples, int points);
  /// The sum of W_ti times what `weights` gives of s.
  double product(int t, int s, const double* of_s) const;
  /// values_i = value for the points whose weight is not 0; of nodes for those of the sample's patch.
  void mark(int s, double value, double* values) const;
  /// values_i += factor of_s_i for the points that count at s.
  void add(int s, double factor, const double* of_s, double* values) const;
  void add(int s, const Vec3& factor, const double* of_s, Points& values) const;

 private:
  template <int columns>
  void at(int s, const double* values, std::ptrdiff_t column, double* sums) const;
  void add(int s, const double* factor, const double* of_s, double* values, int columns, std::ptrdiff_t column) const;
  /// Number of the first point that counts.
  int begin(int s) const { return first_[s][0] + counts_[0] * (first_[s][1] + counts_[1] * first_[s][2]); }
  const double* factors(int s) const { return &factors_[std::size_t(s) * (width_[0] + width_[1] + width_[2])]; }

  Lattice lattice_;
  std::array<int, 3> counts_, width_;      ///< control points of the lattice, and of them that count at a sample, per axis
  bool fours_;                             ///< four of them on every axis
  std::vector<Vec3> places_;               ///< [m]
  std::vector<std::array<int, 3>> first_;  ///< of the points that count, per axis
  std::vector<double> factors_;            ///< of each sample those of x, y and z
};

}  // namespace softffd
