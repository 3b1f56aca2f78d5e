/// Eight control points that meet one plane: the rule of contact.hpp for one point and one plane, in all lanes at once.
///
/// A point comes here when the drift takes it behind the plane, and stays until the end of the step. What lanes behind the last point hold
/// is read by nobody. Points never mix, so the bits do not depend on who their neighbours are.
#pragma once
#include <cstring>

#include "model/plane.hpp"

namespace softffd {

struct alignas(64) Octet {
  static constexpr int lanes = 8;
  using Number = double[lanes];
  using Vector = double[3][lanes];

  int plane = 0, count = 0;
  int point[lanes] = {};
  bool run = true;           ///< the points follow each other in memory
  Vector x0{}, before{};     ///< at the start of the step [m], [m/s]
  Vector force{};            ///< there; in the end the mean of both ends [N]
  Vector x1{}, v{};          ///< after the drift [m]; after the kick at hand [m/s]
  Vector unkicked{};         ///< v before the closing kick [m/s]
  Number mass{}, damping{};  ///< of the point [kg], [N s/m]
  Number inertia{};          ///< impulse that a change of v by 1 m/s stands for in the kick at hand [N s per m/s]
  Vector impulse{};          ///< of the correction at hand on the point [N s]
  Vector torque{};           ///< of it on the obstacle about its point [N m s]
  Vector received{};         ///< impulse of the whole step on the point [N s]
  Number work{};             ///< of the obstacle's own motion in it [J]

  unsigned all() const { return (1u << count) - 1; }  ///< bits of the lanes that hold points
  void clear(int of_plane) { plane = of_plane, count = 0, run = true; }
  void add(int p) {
    run = run && (count == 0 || p == point[count - 1] + 1);
    point[count++] = p;
  }

  /// Between numbers of all points and lanes.
  void fetch(const double* from, Number& to) const {
    if (run && count == lanes) return void(std::memcpy(to, from + point[0], sizeof to));
    for (int lane = 0; lane < count; ++lane) to[lane] = from[point[lane]];
  }
  void fetch(const Points& from, Vector& to) const {
    for (int c = 0; c < 3; ++c) fetch(from.data() + c * from.rows(), to[c]);
  }
  void add_from(const Points& from, Vector& to) const {
    for (int c = 0; c < 3; ++c) {
      const double* column = from.data() + c * from.rows();
      if (run && count == lanes)
        for (int lane = 0; lane < lanes; ++lane) to[c][lane] += column[point[0] + lane];
      else
        for (int lane = 0; lane < count; ++lane) to[c][lane] += column[point[lane]];
    }
  }
  void put(const Vector& from, Points& to) const {
    for (int c = 0; c < 3; ++c) {
      double* column = to.data() + c * to.rows();
      if (run && count == lanes)
        std::memcpy(column + point[0], from[c], sizeof from[c]);
      else
        for (int lane = 0; lane < count; ++lane) column[point[lane]] = from[c][lane];
    }
  }

  /// Takes over what `settle` made of a lane.
  void take(int lane, const Octet& other) {
    for (auto part : {&Octet::v, &Octet::impulse, &Octet::torque, &Octet::received})
      for (int c = 0; c < 3; ++c) (this->*part)[c][lane] = (other.*part)[c][lane];
    work[lane] = other.work[lane];
  }
};

inline Vec3 lane_of(const Octet::Vector& v, int lane) { return {v[0][lane], v[1][lane], v[2][lane]}; }
inline void set_lane(Octet::Vector& v, int lane, const Vec3& value) {
  for (int c = 0; c < 3; ++c) v[c][lane] = value[c];
}

/// The plane at the start, in the middle and at the end of a step of size h [s].
struct Approach {
  HalfSpace start, middle, end;
  double friction, h;
};

/// After the free drift: corrects x1 and v. Gaps at the start up to `touching` [m] are contact. Returns the bits of the lanes whose points
/// came onto the plane, not of those that were there.
unsigned meet(const Approach& plane, double touching, Octet& octet);
/// After the closing half kick: corrects v.
void settle(const Approach& plane, Octet& octet);
/// What contact took from the energy of each point in the step [J]. Over the whole step its kinetic energy changes by (J + h F) . w, where
/// J is the impulse of its contacts, F the mean of the forces (in `force` now) and w of the velocities at both ends; the forces' own work
/// is F . (x1 - x0).
void weigh(double h, const Octet& octet, Octet::Number& lost);
/// Gaps of x1 [m].
void gaps_of(const HalfSpace& plane, const Octet& octet, Octet::Number& gaps);

}  // namespace softffd
