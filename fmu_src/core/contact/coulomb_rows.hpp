/// Coulomb's law at contact constraints (rows) that move each other in all directions. Row s has the force f_s, with the normal part
/// l_s = n . f_s, and the displacement u_s:
///
///      u = u0 + G (f - f0),      l_s >= 0,      n . u_s >= 0,      l_s n . u_s = 0,
///      |f_s - l_s n| <= mu l_s, against the slip u_s - n n . u_s where the slip is not 0.
///
/// As an equation (Alart & Curnier 1991), with the compliance r_s of each row and the projection P onto the forces that the law allows:
///
///      f_s = P(f_s - u_s / r_s),   P(a): normal part l = max(0, n . a), the rest no longer than mu l.
///
/// A semi-smooth Newton's method solves this equation. Where it runs in circles, sweeps correct one row after the other. With D the
/// derivative of P, a Newton step solves f = D (f - u / r). It depends only on the direction of the aim a = f - u / r of each row:
///
///      open:    f = 0
///      sticks:  u = 0, which involves G alone: these rows are eliminated (sticking_rows.hpp)
///      slides:  f = l (n + mu a) + k c along its aim a and across it, c = n x a, with n . u = 0 and k = T (k - c . u / r);
///               T = mu n . aim / |aim - n n . aim|: how far the force turns with its aim
#pragma once
#include <vector>

#include "contact/operations.hpp"
#include "contact/sticking_rows.hpp"
#include "model/types.hpp"

namespace softffd {

/// Block: type of the blocks of G; a number if masses alone resist the forces, because masses have no direction; otherwise (3, 3).
template <class Block>
class CoulombRows {
 public:
  struct Problem {
    std::vector<Vec3> normals;
    std::vector<double> friction;  ///< coefficients
    std::vector<Block> g;          ///< (rows * rows) [m/N]
    std::vector<Vec3> u;           ///< at the initial forces: gap along the normal, slip across the normal [m]
    std::vector<Vec3> aims;        ///< initial aims, of any length; empty: the aims follow from the forces
    double exact;                  ///< allowed violation of the law [m]
  };

  /// Solves for the forces. force: initial forces, become the solution [N]. Returns the remaining violation of the law [m], which is above
  /// `exact` if the operations or the rounds were not enough.
  double solve(const Problem& problem, Operations& operations, std::vector<Vec3>& force);
  Count iterations() const { return iterations_; }

 private:
  /// Directions and turning factor of a sliding row.
  struct Sliding {
    Vec3 along, across;  ///< n + mu a, c
    double turn;         ///< T
  };
  void find_displacements(const Problem& problem, const std::vector<Vec3>& force);
  double look(const Problem& problem, const std::vector<Vec3>& force);
  double newton_work() const;
  bool newton_step(const Problem& problem, Operations& operations, std::vector<Vec3>& force);
  void sort(const Problem& problem);
  void let_go(const Problem& problem, std::vector<Vec3>& force);
  void assemble(const Problem& problem);
  bool solve_sliding(const Problem& problem, const std::vector<Vec3>& force);
  void sweep(const Problem& problem, std::vector<Vec3>& force);

  std::vector<double> own_;  ///< compliance r of each row, the mean over the directions
  std::vector<Vec3> start_, best_;
  std::vector<Vec3> u_, aims_;                   ///< displacements and aims at the forces that `look` has seen
  std::vector<int> sticking_, rest_, touching_;  ///< rows that stick; that do not stick; that are not open, sticking rows first
  std::vector<Sliding> sliding_;                 ///< of the touching rows after the sticking ones
  StickingRows<Block> matrix_;                   ///< of the touching rows
  std::vector<Vec3> change_;                     ///< of the touching rows: change of displacements, then of forces
  std::vector<double> slopes_, right_;
  Count iterations_ = 0;
};

}  // namespace softffd
