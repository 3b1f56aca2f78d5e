/// Explicit contact of control points with obstacle planes: no control point is behind a plane at the end of any internal step. By the
/// convex hull property of the Bezier volume, no point of the object is behind a plane then.
///
/// A step goes from t0 to t1 = t0 + h: opening half kick, drift, forces at t1, closing half kick. Points without contact need no more. A
/// point that the drift would take behind a plane follows the local-restart rule, independently of other points and without event search:
///
///      gap                                            th = gap0 / (gap0 - gap1): fraction of the step before impact
///      gap0 *---__                                    u  = v + (th - 1/2) h a: velocity at the impact (v lives at t0 + h/2)
///               ---__                                 R  = w - u.n: normal impulse that leaves the point the plane's normal velocity w
///      0    ----------x=============== plane          tangentially Coulomb: slip shrinks by the factor max(0, 1 - mu R / |slip|)
///           t0      th  \       t1                    the point lies exactly on the plane at t1
///                        gap1
///
/// The plane's normal velocity w at the point follows from the gaps, w = n.v - (gap1 - gap0) / h; the velocity of the plane's surface is
/// taken at mid-step, at x0 + h/2 v. A gap of at most 1e-12 of the largest side of the box counts as contact.
///
/// A point that was already on the plane (gap0 = 0) gets the impulse R that keeps the point there. Friction opposes the mean of the slips
/// before and after the kick; the point sticks if friction suffices. At t1 the same rule is applied to the velocities after the closing
/// half kick. Each half kick thus has its own reaction: cutting a communication step in two changes nothing, and a plane that is
/// withdrawn between two steps takes no part of the next kick with it.
///
/// A point that ends behind further planes is projected exactly onto all of them by FeasibleSet. A plane that has jumped (its pose at the
/// communication point does not continue its motion) moves points without giving them velocity.
///
/// Most points touch one plane and are processed eight at a time (octet.hpp). While the same points touch, their octets are kept from
/// step to step. The impulses reported are exactly the momentum that the body lost: m R after the opening kick, m (1 + g) R after the
/// closing kick, whose damping is implicit.
#pragma once
#include "body/kick.hpp"
#include "contact/feasible.hpp"
#include "contact/octet.hpp"
#include "model/drive.hpp"
#include "model/exchange.hpp"

namespace softffd {

/// One internal step as pins and contacts see it; the forces are those of the current half kick.
struct StepView {
  const Body& body;
  const HalfKicks& kicks;
  const Drive& around;
  const Points& spring;  ///< spring forces [N]
  const Points& force;   ///< outside forces [N]
  const Points& x0;      ///< positions at t0 [m]
  double t0, t1, h;
};

class Contact {
 public:
  Contact(int points, int planes);

  /// Moves points out of planes at a communication point without changing velocities. Sets `moved` if a point was moved.
  StepStatus clear_jumps(const Body& body, const Drive& around, double time, Points& x, bool& moved);

  /// Prepares steps of size h from t0 on.
  void begin(const Drive& around, double t0, double h);

  /// Finds the points that the free drift x1 = x0 + h v has taken behind a plane.
  void find(const StepView& step, const Points& x1);
  /// To be called after `find`: corrects x1 and v of the points found. `before`: v before the kick.
  StepStatus drift(const StepView& step, const Points& before, Points& v, Points& x1, Exchange& exchange);

  /// After the closing half kick: corrects v of the points that the last drift corrected.
  StepStatus close(const StepView& step, Points& v, Exchange& exchange);

  /// The same if the next opening half kick and its free drift x1 have already been done without the correction: repeats both for the
  /// corrected points. Their octets are then ready for the next drift, which need not gather them again if the same points are behind the
  /// plane.
  StepStatus close_and_go_on(const StepView& step, Points& v, Points& x1, Exchange& exchange);

  bool touched() const { return !touched_.empty(); }
  /// True if there is one plane and the last drift took the same points behind the plane as the drift before.
  bool same() const { return same_; }
  /// The points found, plane by plane: one bit for each point of the body, eight in a byte.
  const std::vector<unsigned char>& behind() const { return behind_; }
  /// The points that the last `find` has found.
  const std::vector<int>& points() const { return touched_; }
  /// Number of impacts so far: counts points that came onto a plane, not points that stayed on one.
  Count impacts() const { return impacts_; }

 private:
  void gather(const StepView& step, const Points& before, const Points& v, const Points& x1);
  bool group(const StepView& step, const Points& x1);
  StepStatus book_close(const StepView& step, Points& v, Exchange& exchange);
  static void book(const Octet& octet, unsigned lanes, Exchange& exchange);
  int deepest(const Vec3& x1) const;

  // several_contacts.cpp
  StepStatus drift_lanes(const StepView& step, const Points& v, const Points& x1, Octet& octet, Exchange& exchange);
  StepStatus drift_lane(const StepView& step, Octet& octet, int lane, Vec3& x1, Vec3& v, Exchange& exchange);
  StepStatus close_lanes(const StepView& step, Points& v, Octet& octet, Exchange& exchange);
  StepStatus close_lane(const StepView& step, const Points& kicked, Octet& octet, int lane, Exchange& exchange);
  unsigned alone_after_drift(const Octet& octet) const;
  unsigned alone_at_the_end(const Octet& octet, double contact) const;
  void book(Octet& octet, int lane, int plane, const Vec3& impulse, const Vec3& x1, Exchange& exchange) const;

  std::vector<HalfSpace> start_, end_;        ///< the planes at the communication point (`clear_jumps`), and at the end of the step
  std::vector<Approach> approach_;            ///< the planes during a step in which points touch
  std::vector<unsigned char> behind_, were_;  ///< bits of the points behind each plane, by the last two drifts
  std::vector<int> touched_;                  ///< points behind a plane after the last drift
  std::vector<Octet> octets_;                 ///< the points of `touched_` without a pin, by plane; the first `used_` octets are in use
  int used_ = 0;
  bool same_ = false;      ///< the points found are the same as in the drift before
  bool at_hand_ = false;   ///< the octets already hold the data of the step that has begun
  Count grouped_ = -1;     ///< version of the body for which octets hold the points of the last drift; -1: none
  Octet before_closing_;   ///< an octet before its closing correction
  std::vector<int> open_;  ///< (planes) octet that still has room; -1: none
  std::vector<Constraint> constraints_;
  std::vector<int> active_;  ///< plane of each constraint
  FeasibleSet feasible_;
  Scalars gap_;
  std::vector<char> marked_;
  Count impacts_ = 0;
};

/// Returns the number of control points that touch a half-space. length: largest side of the box [m].
Count points_on(const HalfSpace& obstacle, double length, const Points& x);

}  // namespace softffd
