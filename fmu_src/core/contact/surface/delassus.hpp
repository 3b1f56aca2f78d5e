/// The Delassus operator of rows: how far a force along one row moves the body along another.
///
/// A row is a sample of the surface at a plane; the inverse masses of the control points are 1/m_i, 0 of pinned ones. A force f at sample t
/// moves sample s by G_st f with one number, for masses have no direction and weights no axis,
///
///      G_st = sum_i W_si W_ti / m_i,      along the rows' normals (n_s . n_t) G_st = A_st.
///
/// A = L L' is kept factored, and so is that of the rows before these: where other samples slide than press, the two take turns. Rows are
/// appended and dropped one at a time; sorted rows, by plane and sample, have the same bits however they were come by.
#pragma once
#include "body/samples.hpp"
#include "contact/free/free_rows.hpp"
#include "contact/operations.hpp"
#include "contact/surface/row_factor.hpp"

namespace softffd {

/// GapFunction above a plane, which are linear in those of the control points.
struct GapFunction {
  Scalars of_points;  ///< (points); none where the plane is of one sample alone, as a solid's tangent is:
  int sample = -1;
  double of_sample = 0;

  double at(const Samples& samples, int s) const { return sample < 0 ? samples.at(s, of_points.data()) : of_sample; }
  /// Of these positions above a plane, or of velocities along its normal. Returns whether any may be below 0.
  bool find(const Samples& samples, const Points& x, const Vec3& normal, double offset);
  /// By this motion of the control points in the range.
  void add_motion(const Samples& samples, PointRange range, const Points& move, const Vec3& normal);
};

class Delassus {
 public:
  explicit Delassus(const Samples& samples) : samples_(&samples) {}

  /// What free bodies yield too, from the next rows on; null: there are none.
  void set_free(FreeRows* free) { free_ = free; }
  FreeRows* free() const { return free_; }

  /// A stretch of steps: what rows at hand from before it spare counts as work, so that a stored state goes on as its instance does.
  void begin();
  /// No row is at hand, nor one that was.
  void forget();
  /// Inverse masses (points) that all rows are to have from now on; those at hand are forgotten.
  void set_masses(const Scalars& inverse);
  /// The planes' unit normals; existing rows are factored anew if one has changed.
  void set_normals(const std::vector<Vec3>& normals);
  /// These rows, sorted, in the place of those at hand.
  void set_rows(const std::vector<SurfaceRow>& rows);
  /// The same without the factor, for `stick`.
  void list_rows(const std::vector<SurfaceRow>& rows);

  int size() const { return int(rows_.size()); }
  const std::vector<SurfaceRow>& rows() const { return rows_; }
  const Samples& samples() const { return *samples_; }
  double cosine(int p, int q) const { return cosines_.empty() ? between(p, q) : cosines_[p * int(normals_.size()) + q]; }
  /// G of rows s and t at hand.
  double operator()(int s, int t) const { return s < t ? g_[start(t) + s] : g_[start(s) + t]; }

  /// The same in all directions, with what free bodies yield.
  Eigen::Matrix3d block(int s, int t) const;

  /// A row that might be appended: its column of G and what the rows at hand leave of its own compliance.
  struct Column : RowFactor::Column {  ///< of A; its own element is G_ss
    SurfaceRow row;
    std::vector<double> over_mass, g;  ///< W / m; G with the rows at hand
    double diagonal = 0;               ///< of G
    Handles handles;
  };
  void prepare(SurfaceRow row, Column& column) const;  ///< all of it
  void project(Column& column) const;                  ///< half, response, left, after rows were dropped
  void append(const Column& column);
  void drop(int row, Column* column = nullptr);  ///< of the column's too
  /// Sorts the rows, and factors anew where they were not.
  void sort();

  /// b becomes A^-1 b.
  void solve(double* b) const {
    operations_.spend(3.0 * size() * size());
    factor_.solve(b);
  }
  /// The same with `together` columns, b (size, together) row by row.
  static constexpr int together = RowFactor::together;
  void solve_together(double* b) const { factor_.solve_together(b); }
  /// Forces by which the rows stick that are away from where they would [m], where bodies are free.
  void stick(const std::vector<Vec3>& away, std::vector<Vec3>& forces);
  /// gaps = begin, moved by these forces of the rows along their normals.
  void apply_impulses(const std::vector<double>& forces, const std::vector<GapFunction>& begin, std::vector<GapFunction>& gaps);
  /// values_i += f W_si / m_i for row s.
  void push(int s, double f, double* values) const { samples_->add(rows_[s].sample, f, over_mass(s), values); }
  /// Points that rows move, and perhaps others; all where not all points count at a sample.
  PointRange range() const { return free_ && free_->any_pin() ? PointRange{0, int(inverse_.size())} : range_; }
  /// Those of its rows, and of who solves for them.
  Operations& operations() const { return operations_; }
  /// What these forces of all rows move the body by, to (points, 3), and free bodies, of which the pins' parts take their points along.
  void push(const std::vector<Vec3>& forces, Points& move) const;
  /// Gaps by what the last push moves the points by, and free obstacles.
  void move_gaps(const Points& move, std::vector<GapFunction>& gaps) const;

 private:
  double between(int p, int q) const;
  static std::size_t start(int row) { return RowFactor::start(row); }
  const double* over_mass(int s) const { return &over_mass_[std::size_t(s) * samples_->support()]; }
  double element(const SurfaceRow& a, const double* of_a, const SurfaceRow& b, const double* of_b) const;
  void exchange();
  double work_of_rows() const;
  double work_of_factor(int from) const;
  void factor(int from);
  void find_range(int from);
  /// Along the normals, what free bodies yield.
  double yield(const SurfaceRow& a, const Handles& of_a, const SurfaceRow& b, const Handles& of_b) const {
    return normals_[a.plane].dot(free_->between(of_a, of_b) * normals_[b.plane]);
  }

  const Samples* samples_;
  Scalars inverse_;
  std::vector<Vec3> normals_;    ///< of the planes
  std::vector<double> cosines_;  ///< of the angles between them, (planes * planes), where they are few
  std::vector<SurfaceRow> rows_;
  std::vector<double> over_mass_;  ///< W / m of each row, (support) each
  FreeRows* free_ = nullptr;
  std::vector<Handles> handles_;  ///< of the rows, where there are free bodies
  RowFactor masses_;              ///< of G alone, for these samples
  std::vector<int> of_masses_;
  PointRange range_;
  std::vector<double> g_;  ///< lower triangle, row by row
  RowFactor factor_;
  Scalars field_;             ///< of the forces of one plane's rows, along its normal
  std::vector<Vec3> pushes_;  ///< of rows of several planes
  Points move_;               ///< by them
  mutable Operations operations_;
  bool sorted_ = true, counted_ = false;  ///< have the rows at hand counted since `begin`?
  struct {
    std::vector<SurfaceRow> rows;
    std::vector<double> over_mass, g;
    RowFactor factor;
    PointRange range;
    bool sorted = false;  ///< and of the masses and normals at hand
  } before_;              ///< where nothing is free: rows in whose place others have come
};

}  // namespace softffd
