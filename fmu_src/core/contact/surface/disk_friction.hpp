/// Friction on parallel planes, at samples whose normal forces are known: minimise 1/2 p.G p + p.s over the disks |p_t| <= limit_t along
/// their planes.
///
/// s is the slip without friction, p the friction; its solution has p_t inside its disk where the slip s + G p vanishes, and on the rim
/// against the slip elsewhere. Where nothing slid last, everything may stick, which the normal forces' own factor tells; else the rows that
/// slid last slide again, nearly always, which Newton's method on p = disk(p - slip(p) / G_tt) tells (Alart & Curnier 1991); where few
/// slide, in unknowns of theirs alone, by that factor. Where both fail, sweeps over the disks, which always converge, lead closer.
///
/// All in the two coordinates of the planes.
#pragma once
#include "contact/surface/delassus.hpp"

namespace softffd {

/// Of its limit, friction from which on a row slid.
inline constexpr double slid = 1 - 1e-9;

struct Disks {
  const Delassus& rows;
  const std::vector<Vec3>& normals;  ///< of the planes
  const std::vector<double>& limit;  ///< per row, >= 0
  const std::vector<Vec3>& slip;     ///< per row without friction, tangential
};

class DiskFriction {
 public:
  /// p: per row; where to start, becomes the friction. Returns by what share of the largest slip the law may be missed.
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

  /// Of Newton's method.
  struct Unknown {
    int row;
    Pair along;
    double turn;  ///< of the row's friction by its aim, relative; 1: it sticks
  };
  int count_ = 0;
  std::vector<double> inverse_own_;                  ///< 1 / G_tt
  std::vector<double> g_;                            ///< (count * count)
  std::vector<Pair> p_, best_, free_slips_, slips_;  ///< slips: with the friction that was looked at last
  std::vector<Pair> stuck_;                          ///< friction by which everything sticks
  std::vector<Unknown> unknowns_;
  std::vector<double> columns_at_once_, slopes_, right_;
  std::vector<double> columns_;  ///< of G^-1, (count) each, of rows that are known
  std::vector<char> known_;
  bool all_free_ = false, stuck_known_ = false;
  std::vector<int> free_, sliding_;  ///< rows whose limits are above 0; of them those that slide
};

}  // namespace softffd
