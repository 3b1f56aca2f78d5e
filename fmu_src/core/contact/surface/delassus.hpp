/// The Delassus operator of contact constraints: how far a force along one constraint moves the body along another.
///
/// A row is one contact constraint: a sample of the surface at a plane. The inverse masses of the control points are 1/m_i, and 0 for
/// pinned points. A force f at sample t moves sample s by G_st f. G_st is one number, because masses have no direction and weights no
/// axis,
///
///      G_st = sum_i W_si W_ti / m_i,      along the rows' normals (n_s . n_t) G_st = A_st.
///
/// The factor A = L L' is kept, and so is the factor of the rows before the current ones: the two alternate where the samples that slide
/// are not those that press. Rows are appended and dropped one at a time. Sorted by plane and sample, rows give the same bits however
/// they were found.
#pragma once
#include "body/samples.hpp"
#include "contact/free/free_rows.hpp"
#include "contact/operations.hpp"
#include "contact/surface/row_factor.hpp"

namespace softffd {

/// Gaps of samples above a plane. They are linear in the gaps of the control points.
struct GapFunction {
  Scalars of_points;     ///< of the control points (points); empty where a plane is for one sample only, as a supporting half-space is
  int sample = -1;       ///< that sample; -1: the plane is for all samples
  double of_sample = 0;  ///< its gap

  double at(const Samples& samples, int s) const { return sample < 0 ? samples.at(s, of_points.data()) : of_sample; }
  /// Computes the gaps of positions x above a plane, or of velocities x along its normal. Returns whether any of them may be below 0.
  bool find(const Samples& samples, const Points& x, const Vec3& normal, double offset);
  /// Adds the motion `move` of the control points in the range.
  void add_motion(const Samples& samples, PointRange range, const Points& move, const Vec3& normal);
};

class Delassus {
 public:
  explicit Delassus(const Samples& samples) : samples_(&samples) {}

  /// Includes the compliance of free bodies, from the next rows on. Null: there are no free bodies.
  void set_free(FreeRows* free) { free_ = free; }
  FreeRows* free() const { return free_; }

  /// Begins a sub-interval. Rows kept from before save work that still counts as work, so that a stored state goes on as its instance
  /// does.
  void begin();
  /// Drops the current rows and the rows before them.
  void forget();
  /// Sets the inverse masses (points) of all rows from now on. Drops the current rows.
  void set_masses(const Scalars& inverse);
  /// Sets the unit normals of the planes. Existing rows are factored anew if a normal has changed.
  void set_normals(const std::vector<Vec3>& normals);
  /// Replaces the current rows by these, which are sorted.
  void set_rows(const std::vector<SurfaceRow>& rows);
  /// Does the same without the factor, for `stick`.
  void list_rows(const std::vector<SurfaceRow>& rows);

  int size() const { return int(rows_.size()); }
  const std::vector<SurfaceRow>& rows() const { return rows_; }
  const Samples& samples() const { return *samples_; }
  double cosine(int p, int q) const { return cosines_.empty() ? between(p, q) : cosines_[p * int(normals_.size()) + q]; }
  /// Returns G_st of the current rows s and t.
  double operator()(int s, int t) const { return s < t ? g_[start(t) + s] : g_[start(s) + t]; }

  /// Returns the same in all directions (3, 3), with the compliance of free bodies.
  Eigen::Matrix3d block(int s, int t) const;

  /// Samples whose rows may be appended next.
  void expect(const std::vector<int>&) {}
  /// A row that may be appended: its column of G, and the part of its own compliance that the current rows leave.
  struct Column : RowFactor::Column {  ///< of A; its diagonal element is G_ss and the compliance of free bodies
    SurfaceRow row;
    std::vector<double> over_mass, g;  ///< W / m (support); G with the current rows
    double diagonal = 0;               ///< element of G
    Handles handles;
  };
  void prepare(SurfaceRow row, Column& column) const;  ///< computes all of the column
  void project(Column& column) const;                  ///< computes half, response and left again, after rows were dropped
  void append(const Column& column);
  void drop(int row, Column* column = nullptr);  ///< drops it from the column too
  /// Sorts the rows, and factors them anew if they were not sorted.
  void sort();

  /// b becomes A^-1 b.
  void solve(double* b) const {
    operations_.spend(3.0 * size() * size());
    factor_.solve(b);
  }
  /// Solves for `together` columns at once, b (size, together) row by row.
  static constexpr int together = RowFactor::together;
  void solve_together(double* b) const { factor_.solve_together(b); }
  /// Computes the forces by which the rows stick, beside free bodies. away: distance of each row from where it would stick [m].
  void stick(const std::vector<Vec3>& away, std::vector<Vec3>& forces);
  /// Sets gaps to `begin`, changed by the motion due to these forces of the rows along their normals.
  void apply_impulses(const std::vector<double>& forces, const std::vector<GapFunction>& begin, std::vector<GapFunction>& gaps);
  /// values_i += f W_si / m_i for row s.
  void push(int s, double f, double* values) const { samples_->add(rows_[s].sample, f, over_mass(s), values); }
  /// Returns a range that contains all points that the rows move. All points, if not every point counts at each sample.
  PointRange range() const { return free_ && free_->any_pin() ? PointRange{0, int(inverse_.size())} : range_; }
  /// Operations spent on the rows and by the solvers that use this operator.
  Operations& operations() const { return operations_; }
  /// Computes the motion (points, 3) of the body due to these forces of all rows, and the motion of free bodies. The free parts of pins
  /// take the pinned points along.
  void push(const std::vector<Vec3>& forces, Points& move) const;
  /// Adds to the gaps the motion of the points, and of free obstacles, due to the last push.
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
  /// Returns the compliance of free bodies between two rows, along their normals.
  double yield(const SurfaceRow& a, const Handles& of_a, const SurfaceRow& b, const Handles& of_b) const {
    return normals_[a.plane].dot(free_->between(of_a, of_b) * normals_[b.plane]);
  }

  const Samples* samples_;
  Scalars inverse_;
  std::vector<Vec3> normals_;    ///< of the planes
  std::vector<double> cosines_;  ///< of the angles between the normals (planes * planes), if planes are few; else empty
  std::vector<SurfaceRow> rows_;
  std::vector<double> over_mass_;  ///< W / m of each row, (support) each
  FreeRows* free_ = nullptr;
  std::vector<Handles> handles_;  ///< of the rows, if there are free bodies
  RowFactor masses_;              ///< factor of G alone, for the samples of_masses_
  std::vector<int> of_masses_;
  PointRange range_;
  std::vector<double> g_;  ///< lower triangle, row by row
  RowFactor factor_;
  Scalars field_;             ///< motion of the points along a normal, due to rows that are all on its plane
  std::vector<Vec3> pushes_;  ///< forces of rows on several planes
  Points move_;               ///< motion of the points due to these forces
  mutable Operations operations_;
  bool sorted_ = true, counted_ = false;  ///< counted_: the current rows have counted as work since `begin`
  struct {
    std::vector<SurfaceRow> rows;
    std::vector<double> over_mass, g;
    RowFactor factor;
    PointRange range;
    bool sorted = false;  ///< and they belong to the current masses and normals
  } before_;              ///< without free bodies: the rows that the current ones have replaced
};

}  // namespace softffd
