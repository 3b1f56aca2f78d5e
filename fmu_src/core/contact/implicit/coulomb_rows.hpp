/// Coulomb's law at rows that move each other in all directions: forces f_s with normal parts l_s = n . f_s and displacements u_s,
///
///      u = u0 + G (f - f0),      l_s >= 0,      n . u_s >= 0,      l_s n . u_s = 0,
///      |f_s - l_s n| <= mu l_s, against the slip u_s - n n . u_s
///
/// where it is not 0. As an equation (Alart & Curnier 1991), with each row's own compliance r_s, P the projection onto what the law allows:
///
///      f_s = P(f_s - u_s / r_s),   P(a): normal part l = max(0, n . a), the rest no longer than mu l.
///
/// Newton's method for it, semi-smooth; where that runs in circles, sweeps that put one row after the other right.
#pragma once
#include <vector>

#include "model/types.hpp"

namespace softffd {

class CoulombRows {
 public:
  struct Problem {
    std::vector<Vec3> normals;
    std::vector<double> friction;    ///< coefficients
    std::vector<Eigen::Matrix3d> g;  ///< (rows * rows) [m/N]
    std::vector<Vec3> u;             ///< at the forces that the solution begins with: gap along the normal, slip across [m]
    double exact;                    ///< what may be left [m]
  };

  /// force: where to begin, becomes the solution [N]. Returns by how much the law is missed [m].
  double solve(const Problem& problem, std::vector<Vec3>& force);
  Count iterations() const { return iterations_; }

 private:
  double look(const Problem& problem, const std::vector<Vec3>& force);
  bool newton_step(const Problem& problem, std::vector<Vec3>& force);
  void sweep(const Problem& problem, std::vector<Vec3>& force);
  Vec3 aim(int s, const Vec3& force) const { return force - u_[s] / own_[s]; }

  std::vector<double> own_;  ///< compliance of each row, mean of the directions
  std::vector<Vec3> start_, u_, best_;
  std::vector<double> slopes_, right_;
  Count iterations_ = 0;
};

}  // namespace softffd
