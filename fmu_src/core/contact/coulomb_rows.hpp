/// Coulomb's law at rows that move each other in all directions: forces f_s with normal parts l_s = n . f_s and displacements u_s,
///
///      u = u0 + G (f - f0),      l_s >= 0,      n . u_s >= 0,      l_s n . u_s = 0,
///      |f_s - l_s n| <= mu l_s, against the slip u_s - n n . u_s
///
/// where it is not 0. As an equation (Alart & Curnier 1991), with each row's own compliance r_s, P the projection onto what the law allows:
///
///      f_s = P(f_s - u_s / r_s),   P(a): normal part l = max(0, n . a), the rest no longer than mu l.
///
/// Newton's method for it, semi-smooth; where that runs in circles, sweeps that put one row after the other right. With D the derivative of
/// P, a step solves f = D (f - u / r), which needs of an aim only where it points:
///
///      open:    f = 0
///      sticks:  u = 0, which G alone tells: these rows are eliminated by a partial factor of G
///      slides:  f = l (n + mu a) + k c along its aim a and across it, c = n x a, with n . u = 0 and k = T (k - c . u / r);
///               T = mu n . aim / |aim - n n . aim|: how far it turns with its aim
#pragma once
#include <vector>

#include "contact/operations.hpp"
#include "matrix/partial_factor.hpp"
#include "model/types.hpp"

namespace softffd {

/// Block: of G; a number where masses alone hold the body, which know no direction, else (3, 3).
template <class Block>
class CoulombRows {
 public:
  struct Problem {
    std::vector<Vec3> normals;
    std::vector<double> friction;  ///< coefficients
    std::vector<Block> g;          ///< (rows * rows) [m/N]
    std::vector<Vec3> u;           ///< at the forces that the solution begins with: gap along the normal, slip across [m]
    std::vector<Vec3> aims;        ///< where they point to begin with, of any length; none: by the forces
    double exact;                  ///< what may be left [m]
  };

  /// force: where to begin, becomes the solution [N]. Returns by how much the law is missed [m], more where the operations are spent.
  double solve(const Problem& problem, Operations& operations, std::vector<Vec3>& force);
  Count iterations() const { return iterations_; }

 private:
  /// A row that slides.
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
  void set(int i, int j, const Block& transposed);
  template <class Solve>
  void for_all_sides(Solve solve);
  Block left(int i, int j);
  bool solve_sliding(const Problem& problem, const std::vector<Vec3>& force);
  void sweep(const Problem& problem, std::vector<Vec3>& force);

  std::vector<double> own_;  ///< compliance of each row, mean of the directions
  std::vector<Vec3> start_, best_;
  std::vector<Vec3> u_, aims_;                   ///< at the forces that were looked at
  std::vector<int> sticking_, rest_, touching_;  ///< rows that stick, that do not, and that are not open: sticking ones first
  std::vector<Sliding> sliding_;                 ///< after those
  PartialFactor factor_;                         ///< of the touching rows: those that stick are eliminated
  std::vector<Vec3> change_;                     ///< of their displacements, then of their forces
  std::vector<double> slopes_, right_;
  Count iterations_ = 0;
};

}  // namespace softffd
