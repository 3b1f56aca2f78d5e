/// The Delassus operator of contact constraints (rows) in the metric of an implicit step's matrix A: how a force at a sample moves another.
///
/// A force f at sample t moves the body by Z_t f, with Z_t = A^-1 (W_t (x) I), which takes three solutions with A. It moves sample s by
/// G_st f. G_st has 3 x 3 numbers because A, unlike masses, depends on directions:
///
///      G_st = sum_i W_si Z_ti,      along the rows' normals n_s . G_st n_t.
///
/// The rows are the same as in Delassus (surface/delassus.hpp), and so are the functions that DualActiveSetIn uses.
#pragma once
#include <memory>

#include "contact/implicit/step_matrix.hpp"
#include "contact/surface/delassus.hpp"

namespace softffd {

class StepDelassus {
 public:
  explicit StepDelassus(const Samples& samples) : samples_(&samples), index_(samples.all(), -1) {}

  /// Includes the compliance of free obstacles; null: there are none. The twists in `free` are those due to the last forces.
  void set_free(FreeRows* free) { free_ = free; }

  /// Sets the normals of the planes (planes), valid until the next call. Drops the current rows.
  void set_planes(const std::vector<Vec3>& normals);
  /// Sets the factored matrix from which responses follow from now on; it is read until the next call. Drops responses and rows. Pinned
  /// points do not move.
  void set_matrix(StepMatrix& matrix, const Body& body);
  /// Drops the responses of a kept matrix if there are many of them.
  void forget_many();

  int size() const { return int(rows_.size()); }
  const std::vector<SurfaceRow>& rows() const { return rows_; }
  const Samples& samples() const { return *samples_; }
  void set_rows(const std::vector<SurfaceRow>& rows);

  struct Column : RowFactor::Column {
    SurfaceRow row;
  };
  void prepare(SurfaceRow row, Column& column);
  void project(Column& column);
  void append(const Column& column);
  void drop(int row, Column* column = nullptr);
  void sort();
  void solve(double* b) const {
    operations_.spend(3.0 * size() * size());
    factor_.solve(b);
  }
  void apply_impulses(const std::vector<double>& forces, const std::vector<GapFunction>& begin, std::vector<GapFunction>& gaps);

  /// Operations spent, as in Delassus, but without those of the solutions with the matrix.
  Operations& operations() const { return operations_; }

  /// Returns G of two samples [m/N] (3, 3); `block` returns G of two rows, with the compliance of free obstacles.
  Eigen::Matrix3d operator()(int s, int t);
  Eigen::Matrix3d block(const SurfaceRow& a, const SurfaceRow& b);
  /// Returns the compliance of friction on a solid's own sample (FreeRows::give) [m/N].
  double give(const SurfaceRow& row);
  /// Computes the responses of these samples together.
  void respond(const std::vector<int>& samples);
  /// Announces samples whose responses may be needed next. They are computed together with the next response that is asked for, as many as
  /// one solution has room for.
  void expect(const std::vector<int>& samples) { expected_ = samples; }
  /// u += Z_s f [m].
  void add_response(int s, const Vec3& f, Points& u);
  /// f_i += W_si f [N].
  void spread(int s, const Vec3& f, Points& forces) const;

 private:
  struct Response {
    int sample;
    std::array<Points, 3> moved;              ///< by a unit force along each axis [m/N]
    std::vector<Eigen::Matrix3d> compliance;  ///< G with the samples of earlier and its own response, by the motion due to the later sample
  };
  const Response& response(int s);
  void add_compliance(Response& made);
  void forget_responses();
  Eigen::Matrix3d compliance(int i, int j) const;
  double element(const SurfaceRow& a, const SurfaceRow& b);
  void factor(int from);

  const Samples* samples_;
  StepMatrix* matrix_ = nullptr;
  const Body* body_ = nullptr;
  FreeRows* free_ = nullptr;
  std::vector<Vec3> normals_;
  std::vector<std::unique_ptr<Response>> responses_;  ///< in the order in which they were requested
  std::vector<int> index_;                            ///< (samples) index of each sample's response; -1: none yet
  std::vector<SurfaceRow> rows_;
  RowFactor factor_;
  Points move_;
  mutable std::vector<double> weights_;
  std::vector<Points*> sides_;
  std::vector<int> expected_;
  mutable Operations operations_;
};

}  // namespace softffd
