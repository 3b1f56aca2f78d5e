/// Eight control points that meet one plane: applies the rule of contact.hpp for one point and one plane to all lanes at once.
///
/// A point enters an octet when the drift takes the point behind the plane, and stays there until the end of the step. Lanes after the
/// last point hold values that are never read. Lanes never mix, so the bits of a point do not depend on the other points of the octet.
#pragma once
#include <cstring>

#include "model/plane.hpp"

namespace softffd {

struct Octet {
  static constexpr int lanes = 8;
  static constexpr unsigned every = (1u << lanes) - 1;
  static constexpr int line = 64;  ///< cache line [bytes]; a value across its border is slow to read right after it was written
  using Number = double[lanes];
  using Vector = double[3][lanes];

  int plane = 0, count = 0;
  int point[lanes] = {};           ///< number of each point; lanes after the last point repeat the last point
  bool run = true;                 ///< the points are consecutive in memory
  unsigned alone = 0;              ///< bits of the lanes whose points touch this plane and no other after the drift
  alignas(line) Number mass{};     ///< mass of the point [kg]
  Number damping{};                ///< nodal viscous drag of the point [N s/m]
  Number opening{}, closing{};     ///< impulse per change of v in each half kick [N s per m/s]
  Number keep{}, gain{};           ///< coefficients of the opening kick: v <- keep v + gain f
  Vector x0{}, before{}, force{};  ///< position, velocity and force at the start of the step [m], [m/s], [N]
  Vector x1{}, v{};                ///< position after the drift [m]; velocity after the current kick [m/s]
  Vector spring{}, outside{};      ///< forces at the end of the step [N]
  Vector impulse{}, torque{};      ///< on the obstacle by the current correction, torque about the obstacle's point [N s], [N m s]
  Vector received{};               ///< impulse on the point in the whole step [N s]
  Number work{}, lost{};           ///< in the step: work of the obstacle's own motion; energy that contact took from the point [J]

  unsigned all() const { return (1u << count) - 1; }  ///< bits of the lanes that hold points
  bool whole() const { return run && count == lanes; }
  void clear(int of_plane) { plane = of_plane, count = 0, run = true; }
  void add(int p) {
    run = run && (count == 0 || p == point[count - 1] + 1);
    for (int lane = count++; lane < lanes; ++lane) point[lane] = p;
  }

  /// Copies one lane of the results of `velocity_stage` from another octet.
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
  bool still = false;  ///< the plane is at rest
};

/// Arrays of all points from which `fetch` fills an octet.
struct Gathered {
  const double *mass, *damping, *opening, *closing, *keep, *gain;
  const Points &x0, &before, &spring, &outside, &x1, &v;
};

/// Loads the data of the octet's points; the forces are those at the start of the step.
void fetch(const Gathered& all, Octet& octet);
/// Corrects x1 and v after the free drift, and sets `alone` as if there were no other plane. Gaps up to `touching` [m] count as contact.
/// Returns the bits of the lanes whose points came onto the plane, without those whose points were on the plane already.
unsigned position_stage(const Approach& plane, double touching, Octet& octet);
/// To be called after `position_stage`: writes x1 and v to the arrays of all points.
void put(const Octet& octet, Points& x1, Points& v);
/// Corrects the octet's v after the closing half kick by these forces; v: velocities of all points after that kick.
void velocity_stage(const Approach& plane, const Points& v, const Points& spring, const Points& outside, Octet& octet);
/// To be called after `velocity_stage`: computes the energy that contact took from each point in the step, and writes v to the array of all
/// points. Over the step the kinetic energy of a point changes by (J + h F) . w, where J is the impulse of the point's contacts, F the
/// mean of the forces at both ends and w the mean of the velocities there; the work of the forces is F . (x1 - x0).
void account_energy(double h, Octet& octet, Points& v);
/// `velocity_stage` and `account_energy`.
void close_step(const Approach& plane, Points& v, const Points& spring, const Points& outside, Octet& octet);
/// Does the next step's opening half kick and free drift from the end of this step; writes x1 to the array of all points, v stays here.
void open_step(double h, Octet& octet, Points& x1);
/// `velocity_stage`, `account_energy` and `open_step`.
void close_and_open(const Approach& plane, Points& v, const Points& spring, const Points& outside, Octet& octet, Points& x1);
/// Bits of the lanes where the gap of x1 is at least, and at most, a given value [m].
struct Sides {
  unsigned at_least, at_most;
};
Sides sides(const HalfSpace& plane, const Octet& octet, double gap);

}  // namespace softffd
