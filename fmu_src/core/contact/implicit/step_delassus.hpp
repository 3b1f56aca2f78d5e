/// The Delassus operator of rows in the metric of an implicit step's matrix A: how far a force at one sample moves another.
///
/// A force f at sample t moves the body by Z_t f, Z_t = A^-1 (W_t (x) I), three solutions; sample s by G_st f with 3 x 3 numbers, for A,
/// unlike masses, knows directions,
///
///      G_st = sum_i W_si Z_ti,      along the rows' normals n_s . G_st n_t.
///
/// Rows are those of Delassus, whose functions it has for DualActiveSetIn.
#pragma once
#include <memory>

#include "contact/implicit/step_matrix.hpp"
#include "contact/surface/delassus.hpp"

namespace softffd {

class StepDelassus {
 public:
  explicit StepDelassus(const Samples& samples) : samples_(&samples), index_(samples.all(), -1) {}

  /// What free obstacles yield too; null: there are none. Its twists are those of the last forces.
  void set_free(FreeRows* free) { free_ = free; }

  /// The normals of the planes (planes), until the next call; the rows at hand are forgotten.
  void set_planes(const std::vector<Vec3>& normals);
  /// Responses are those of this factored matrix from now on; read until the next call. Pinned points do not move.
  void set_matrix(StepMatrix& matrix, const Body& body);
  /// The responses of a matrix that is kept, once they are many.
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

  /// As Delassus, those of the matrix's solutions apart.
  Operations& operations() const { return operations_; }

  /// G of two samples [m/N]; and of two rows, with what free obstacles yield.
  Eigen::Matrix3d operator()(int s, int t);
  Eigen::Matrix3d block(const SurfaceRow& a, const SurfaceRow& b);
  /// That of a solid's own sample (FreeRows::give).
  double give(const SurfaceRow& row);
  /// Computes the responses of these samples together.
  void respond(const std::vector<int>& samples);
  /// Samples whose responses may be needed next. They are computed together with another one, as far as the solution has room for them.
  void expect(const std::vector<int>& samples) { expected_ = samples; }
  /// u += Z_s f [m].
  void add_response(int s, const Vec3& f, Points& u);
  /// f_i += W_si f [N].
  void spread(int s, const Vec3& f, Points& forces) const;

 private:
  struct Response {
    int sample;
    std::array<Points, 3> moved;              ///< by a unit force along each axis [m/N]
    std::vector<Eigen::Matrix3d> compliance;  ///< with the samples of the responses before, and its own: by the later sample's motion
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
  std::vector<std::unique_ptr<Response>> responses_;  ///< in the order they were asked for
  std::vector<int> index_;                            ///< (samples) of their responses; -1: none yet
  std::vector<SurfaceRow> rows_;
  RowFactor factor_;
  Points move_;
  mutable std::vector<double> weights_;
  std::vector<Points*> sides_;
  std::vector<int> expected_;
  mutable Operations operations_;
};

}  // namespace softffd
