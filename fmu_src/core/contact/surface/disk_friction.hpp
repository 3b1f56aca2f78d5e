/// Friction on parallel planes, at samples whose normal forces are known: minimise 1/2 p.G p + p.s over the disks |p_t| <= limit_t along
/// their planes.
///
/// s is the slip without friction, p the friction; its solution has p_t inside its disk where the slip s + G p vanishes, and on the rim
/// against the slip elsewhere. Nearly always everything sticks, which the normal forces' own factor tells, or the rows that slid last slide
/// again, which Newton's method on p = disk(p - slip(p) / G_tt) tells (Alart & Curnier 1991); where few slide, in unknowns of theirs alone,
/// by that factor. Where both fail, sweeps over the disks, which always converge, lead closer.
#pragma once
#include "contact/surface/delassus.hpp"

namespace softffd {

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
  bool stick(const Disks& disks, std::vector<Vec3>& p);
  double look(const Disks& disks, const std::vector<Vec3>& p);
  void sweep(const Disks& disks, std::vector<Vec3>& p);
  bool newton_step(const Disks& disks, std::vector<Vec3>& p);
  bool newton_step_of_few(const Disks& disks, std::vector<Vec3>& p);
  void spread(const Delassus& rows);
  double own(int t) const { return g_[t * (count_ + 1)]; }
  void find_columns(const Disks& disks);
  const double* column(int t) const { return &columns_[t * count_]; }
  double sign(const Disks& disks, int t) const;
  Vec3 slip_at(const Disks& disks, const std::vector<Vec3>& p, int t) const;
  bool slides(const Disks& disks, const std::vector<Vec3>& p, int t) const;

  /// Of Newton's method.
  struct Unknown {
    int row;
    Vec3 along;
    double turn;  ///< of the row's friction by its aim, relative; 1: it sticks
  };
  int count_ = 0;
  std::vector<double> g_;  ///< (count * count)
  std::vector<Unknown> unknowns_;
  std::vector<double> one_, slopes_, right_;
  std::vector<double> columns_;  ///< of G^-1, (count) each, of rows that are known
  std::vector<char> known_;
  std::vector<Vec3> best_, slips_;  ///< slips: with the friction that was looked at last
  std::vector<Vec3> stuck_;         ///< friction by which everything sticks
  bool stuck_known_ = false;
  std::vector<int> free_, sliding_;  ///< rows whose limits are above 0; of them those that slide
};

}  // namespace softffd
