/// The Delassus operator of rows: how far a force along one row moves the body along another.
///
/// A row is a sample of the surface at a plane; the inverse masses of the control points are 1/m_i, 0 of pinned ones. A force f at sample t
/// moves sample s by G_st f with one number, for masses have no direction and weights no axis,
///
///      G_st = sum_i W_si W_ti / m_i,      along the rows' normals (n_s . n_t) G_st = A_st.
///
/// A = L L' is kept factored. Rows are appended and dropped one at a time; sorted rows, by plane and sample, have the same bits however
/// they were come by.
#pragma once
#include <limits>

#include "contact/surface/row_factor.hpp"
#include "model/samples.hpp"

namespace softffd {

struct SurfaceRow {
  int plane, sample;
  auto operator<=>(const SurfaceRow&) const = default;
};

class Delassus {
 public:
  explicit Delassus(const Samples& samples) : samples_(&samples) {}

  /// Inverse masses (points) that all rows are to have from now on; existing rows are made anew.
  void set_masses(const Scalars& inverse);
  /// Cosines of the angles between planes, (planes * planes); existing rows are factored anew if one has changed.
  void set_cosines(const std::vector<double>& cosines);
  /// The same by the planes' normals: of many, such as the tangents of solids, no table is made.
  void set_normals(const std::vector<Vec3>& normals);
  /// These rows, sorted, in the place of those at hand.
  void set_rows(const std::vector<SurfaceRow>& rows);

  int size() const { return int(rows_.size()); }
  const std::vector<SurfaceRow>& rows() const { return rows_; }
  const Samples& samples() const { return *samples_; }
  double cosine(int p, int q) const { return normals_.empty() ? cosines_[p * planes_ + q] : between(normals_, p, q); }
  /// G of rows s and t at hand.
  double operator()(int s, int t) const { return s < t ? g_[start(t) + s] : g_[start(s) + t]; }

  /// A row that might be appended: its column of G and what the rows at hand leave of its own compliance.
  struct Column : RowFactor::Column {  ///< of A; its own element is G_ss
    SurfaceRow row;
    std::vector<double> over_mass, g;  ///< W / m; G with the rows at hand
  };
  void prepare(SurfaceRow row, Column& column) const;  ///< all of it
  void project(Column& column) const;                  ///< half, response, left, after rows were dropped
  void append(const Column& column);
  void drop(int row, Column* column = nullptr);  ///< of the column's too
  /// Sorts the rows, and factors anew where they were not.
  void sort();

  /// b becomes A^-1 b.
  void solve(double* b) const { factor_.solve(b); }
  /// The same with `together` columns, b (size, together) row by row.
  static constexpr int together = RowFactor::together;
  void solve_together(double* b) const { factor_.solve_together(b); }
  /// heights = begin, (planes)(points) both, moved by these forces of the rows.
  void raise(const std::vector<double>& forces, const std::vector<Scalars>& begin, std::vector<Scalars>& heights);
  /// values_i += f W_si / m_i for row s.
  void push(int s, double f, double* values) const { samples_->add(rows_[s].sample, f, over_mass(s), values); }
  /// Points that rows move, and perhaps others; all where not all points count at a sample.
  PointRange range() const { return range_; }
  /// Operations on numbers from here on, of which there may be so many: a solver that has spent them gives up.
  void allow(double most) { done_ = 0, most_ = most; }
  void spend(double operations) const { done_ += operations; }
  double done() const { return done_; }
  bool spent() const { return !(done_ <= most_); }
  /// What these forces of all rows move the body by, to (points, 3).
  void push(const std::vector<Vec3>& forces, Points& move) const;

 private:
  static double between(const std::vector<Vec3>& normals, int p, int q);
  static std::size_t start(int row) { return RowFactor::start(row); }
  const double* over_mass(int s) const { return &over_mass_[std::size_t(s) * samples_->support()]; }
  double element(const SurfaceRow& a, const double* of_a, const SurfaceRow& b, const double* of_b) const;
  void factor(int from);
  void find_range(int from);

  const Samples* samples_;
  Scalars inverse_;
  std::vector<double> cosines_;
  std::vector<Vec3> normals_;  ///< of many planes, in the place of cosines
  int planes_ = 0;
  std::vector<SurfaceRow> rows_;
  std::vector<double> over_mass_;  ///< W / m of each row, (support) each
  PointRange range_;
  std::vector<double> g_;  ///< lower triangle, row by row
  RowFactor factor_;
  std::vector<Scalars> fields_;  ///< of the planes' forces, along their normals
  std::vector<int> pushed_;      ///< planes that have any
  mutable double done_ = 0;
  double most_ = std::numeric_limits<double>::infinity();
  bool sorted_ = true;
};

}  // namespace softffd
