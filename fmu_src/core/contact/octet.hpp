/// Eight control points that meet one plane: the rule of contact.hpp for one point and one plane, in all lanes at once.
///
/// A point comes here when the drift takes it behind the plane, and stays until the end of the step. What lanes behind the last point hold
/// is read by nobody. Points never mix, so the bits do not depend on who their neighbours are.
#pragma once
#include <cstring>

#include "model/plane.hpp"

namespace softffd {

struct Octet {
  static constexpr int lanes = 8;
  static constexpr unsigned every = (1u << lanes) - 1;
  static constexpr int line = 64;  ///< of the cache [bytes]; what crosses its border is slow to read right after it was written
  using Number = double[lanes];
  using Vector = double[3][lanes];

  int plane = 0, count = 0;
  int point[lanes] = {};           ///< lanes behind the last point hold it too
  bool run = true;                 ///< the points follow each other in memory
  unsigned alone = 0;              ///< bits of the lanes whose points touch the plane after the drift, and no other
  alignas(line) Number mass{};     ///< of the point [kg]
  Number damping{};                ///< of the point [N s/m]
  Number opening{}, closing{};     ///< impulse that a change of v by 1 m/s stands for in each half kick [N s per m/s]
  Number keep{}, gain{};           ///< of the opening kick: v <- keep v + gain f
  Vector x0{}, before{}, force{};  ///< at the start of the step [m], [m/s], [N]
  Vector x1{}, v{};                ///< after the drift [m]; after the kick at hand [m/s]
  Vector spring{}, outside{};      ///< forces at the end of the step [N]
  Vector impulse{}, torque{};      ///< of the correction at hand on the obstacle, torque about its point [N s], [N m s]
  Vector received{};               ///< impulse of the whole step on the point [N s]
  Number work{}, lost{};           ///< in it, of the obstacle's own motion, and what contact took from the point's energy [J]

  unsigned all() const { return (1u << count) - 1; }  ///< bits of the lanes that hold points
  bool whole() const { return run && count == lanes; }
  void clear(int of_plane) { plane = of_plane, count = 0, run = true; }
  void add(int p) {
    run = run && (count == 0 || p == point[count - 1] + 1);
    for (int lane = count++; lane < lanes; ++lane) point[lane] = p;
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
  bool still = false;  ///< it stays where it is
};

/// What octets hold, of all points.
struct Gathered {
  const double *mass, *damping, *opening, *closing, *keep, *gain;
  const Points &x0, &before, &spring, &outside, &x1, &v;
};

/// Takes what is the octet's points'; forces are those at the start of the step.
void fetch(const Gathered& all, Octet& octet);
/// After the free drift: corrects x1 and v, and sets `alone` as if there were no other plane. Gaps up to `touching` [m] are contact.
/// Returns the bits of the lanes whose points came onto the plane, not of those that were there.
unsigned meet(const Approach& plane, double touching, Octet& octet);
/// Then, x1 and v to those of all points.
void put(const Octet& octet, Points& x1, Points& v);
/// After the closing half kick to v, by these forces: corrects the octet's v.
void settle(const Approach& plane, const Points& v, const Points& spring, const Points& outside, Octet& octet);
/// Then, what contact took from the energy of each point in the step, and v to that of all points. Over the whole step the kinetic energy
/// changes by (J + h F) . w, where J is the impulse of its contacts, F the mean of the forces at both ends and w of the velocities there;
/// the forces' own work is F . (x1 - x0).
void weigh(double h, Octet& octet, Points& v);
/// These two.
void settle_and_weigh(const Approach& plane, Points& v, const Points& spring, const Points& outside, Octet& octet);
/// Then, the next step's opening half kick and free drift: it begins where this one ends. x1 goes to that of all points, v stays here.
void go_on(double h, Octet& octet, Points& x1);
/// All three.
void settle_and_go_on(const Approach& plane, Points& v, const Points& spring, const Points& outside, Octet& octet, Points& x1);
/// Bits of the lanes whose x1 has a gap of at least or at most so much [m].
struct Sides {
  unsigned at_least, at_most;
};
Sides sides(const HalfSpace& plane, const Octet& octet, double gap);

}  // namespace softffd
