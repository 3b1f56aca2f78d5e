/// Friction on parallel planes at samples whose normal forces are known: minimises 1/2 p.G p + p.s over the disks |p_t| <= limit_t along
/// the planes.
///
/// Without friction the slip is s; p is the friction. In the solution, p_t lies inside its disk where the slip s + G p vanishes, and
/// elsewhere on the rim, against the slip. If nothing slid last, everything may stick; the factor of the normal forces decides that.
/// Otherwise the rows that slid last nearly always slide again. Newton's method on p = disk(p - slip(p) / G_tt) finds that solution
/// (Alart & Curnier 1991); if few rows slide, their slips are the only unknowns, and the same factor serves. Where both fail, sweeps over
/// the disks, which always converge, lead closer.
///
/// All vectors are in the two coordinates of the planes.
#pragma once
#include "contact/surface/delassus.hpp"

namespace softffd {

/// A contact constraint counts as sliding if its friction is at least this fraction of the Coulomb limit.
inline constexpr double slid = 1 - 1e-9;

struct Disks {
  const Delassus& rows;
  const std::vector<Vec3>& normals;  ///< of the planes
  const std::vector<double>& limit;  ///< largest friction per row, >= 0
  const std::vector<Vec3>& slip;     ///< per row without friction, tangential
};

class DiskFriction {
 public:
  /// p: start value per row, becomes the friction. Returns the remaining error of the friction law as a fraction of the largest slip.
  double solve(const Disks& disks, std::vector<Vec3>& p);

 private:
  using Pair = Eigen::Vector2d;

  double find_friction(const Disks& disks);
  bool stick(const Disks& disks);
  void find_stuck(const Disks& disks);
  double look(const Disks& disks);
  void sweep(const Disks& disks);
  bool newton_step(const Disks& disks);
  bool newton_step_of_few(const Disks& disks);
  void spread(const Delassus& rows);
  void find_columns(const Disks& disks);
  void find_slips();
  const double* column(int t) const { return &columns_[t * count_]; }
  double sign(const Disks& disks, int t) const;
  Pair aim(int t) const { return p_[t] - inverse_own_[t] * slips_[t]; }

  /// An unknown of Newton's method.
  struct Unknown {
    int row;
    Pair along;
    double turn;  ///< relative change of the row's friction with its aim; 1: the row sticks
  };
  int count_ = 0;
  std::vector<double> inverse_own_;                  ///< 1 / G_tt
  std::vector<double> g_;                            ///< (count * count)
  std::vector<Pair> p_, best_, free_slips_, slips_;  ///< slips_: at the friction evaluated last
  std::vector<Pair> stuck_;                          ///< friction by which everything sticks
  std::vector<Unknown> unknowns_;
  std::vector<double> columns_at_once_, slopes_, right_;
  std::vector<double> columns_;  ///< of G^-1, (count) each, for the rows marked in known_
  std::vector<char> known_;
  bool all_free_ = false, stuck_known_ = false;
  std::vector<int> free_, sliding_;  ///< rows whose limits are above 0; those of them that slide
};

}  // namespace softffd
