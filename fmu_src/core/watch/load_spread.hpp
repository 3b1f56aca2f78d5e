/// Distributes an obstacle's load over the samples of the surface that touch it. The contact rule finds what moves the body; where the
/// samples are closer than the lattice can tell, it leaves open which of them push, and takes a few. The reported load takes two steps.
///
/// First, the touching samples get the load of least norm that moves the control points in the same way,
///
///      min sum_s f_s^2 / A_s        with  sum_s W_si f_s = sum_s W_si g_s for all control points i,   f_s >= 0,
///
/// where g are the forces of the contact rule and A_s the areas. The solution is f_s = A_s max(0, p_s) with a pressure p that is a field
/// of the lattice, found by Newton's method (Mangasarian 2004, A Newton method for linear programming, has the same problem). On a flat
/// face this is the smooth pressure. Where the surface is curved against the obstacle, the lattice touches it at a few points of a cell,
/// and no other distribution is possible.
///
/// Therefore each force is then spread over the samples near the obstacle in the cells of two grids, half as coarse again as the lattice
/// and half a cell from each other, by weights
///
///      f_s <- sum_t A_s c_s h_st c_t f_t,      h_st = sum over the nodes n of both of  H_n(X_s) H_n(X_t),
///
/// where H_n is 1 at its node, 0 at the others and linear along each axis between them, and c is such that sums are kept and an even
/// pressure stays even (Sinkhorn and Knopp 1967). Finally the centre of pressure is restored.
#pragma once
#include <Eigen/Cholesky>
#include <array>
#include <vector>

#include "body/samples.hpp"

namespace softffd {

struct Touch {
  int at;              ///< control point or sample
  bool touches;        ///< false: the sample is near and has no force so far
  double area;         ///< area that faces the obstacle [m2]
  Vec3 place, normal;  ///< [m], unit normal of the obstacle there
  Vec3 force;          ///< force or impulse on the body
};

/// The touches as arrays, one row each, with the force split into the part along the normal, >= 0, and the part across.
struct DistributedLoad {
  std::vector<int> samples;
  std::vector<char> touching;
  Scalars area;
  Points place, normal;
  Scalars along;
  Points across;

  void take(const std::vector<Touch>& touches);
  Vec3 force(int t) const { return along[t] * row(normal, t) + row(across, t); }
  int count() const { return int(samples.size()); }
};

class LoadSpread {
 public:
  explicit LoadSpread(const Samples& samples) : samples_(samples) {}
  /// Distributes the load. The sum of all forces is kept to rounding.
  void distribute(DistributedLoad& load);

 private:
  void distribute_touching(DistributedLoad& load);
  void find_fields();
  void factor(const Scalars& weight);
  bool along(const Scalars& area, Scalars& forces);
  bool across(const Scalars& weight, Points& forces);
  void find_hats(const DistributedLoad& load);
  template <class Values>
  Values times(const Values& values) const;
  void smooth(DistributedLoad& load);

  struct Hats {
    std::array<int, 16> node;
    std::array<double, 16> part;
  };

  const Samples& samples_;
  std::vector<int> touching_, chosen_;  ///< samples that fields_ belong to; their rows of the load
  Eigen::MatrixXd fields_;              ///< (touching, rank): W W^T = fields fields^T
  Eigen::LLT<Eigen::MatrixXd> factor_;
  std::vector<Hats> hats_;  ///< of each row of the load
  int nodes_ = 0;           ///< number of nodes of both grids
};

}  // namespace softffd
