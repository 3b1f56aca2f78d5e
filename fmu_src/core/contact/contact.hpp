/// Contact of control points with obstacle planes, explicit: no control point is behind a plane at the end of any internal step, hence, by
/// the convex hull property of the Bezier volume, no point of the object is.
///
/// A step goes from t0 to t1 = t0 + h: opening half kick, drift, forces at t1, closing half kick. Free points need no more. A point that
/// the drift would take behind a plane follows the local-restart rule, on its own, without event search:
///
///      gap                                            th = gap0 / (gap0 - gap1): the impact's share of the step
///      gap0 *---__                                    u  = v + (th - 1/2) h a: velocity at the impact (v lives at t0 + h/2)
///               ---__                                 R  = w - u.n: the normal impulse that leaves the plane's normal velocity w
///      0    ----------x=============== plane          tangentially Coulomb: slip shrinks by the factor max(0, 1 - mu R / |slip|)
///           t0      th  \       t1                    the point lies exactly on the plane at t1
///                        gap1
///
/// The plane's normal velocity w where the point is follows from the gaps, w = n.v - (gap1 - gap0) / h; the velocity of its surface is
/// taken at mid-step, at x0 + h/2 v. A gap below 1e-12 of the largest side of the box counts as contact.
///
/// A point that was on the plane already (gap0 = 0) gets R that keeps it there; friction opposes the mean of the slip before and after
/// the kick, and holds the point if it can. At t1 the closing half kick is followed by the same rule on velocities. Each half kick thus
/// has its own reaction, so cutting a communication step in two changes nothing, and a plane that is withdrawn between two steps takes
/// no part of the next kick with it.
///
/// A point that ends behind further planes is handed to FeasibleSet: the exact projection onto all of them. A plane that has jumped
/// (its pose at the communication point does not continue its motion) moves points without giving them velocity.
///
/// Most points touch one plane, which they do eight at a time (octet.hpp); while the same points touch they stay at hand from step to step.
/// The impulses that are reported are exactly the momentum that the body lost: m R after the opening kick, m (1 + g) R after the closing
/// one, whose damping is implicit.
#pragma once
#include "body/kick.hpp"
#include "contact/feasible.hpp"
#include "contact/octet.hpp"
#include "model/drive.hpp"
#include "model/exchange.hpp"

namespace softffd {

/// One internal step as pins and contacts see it; forces are those of the half kick at hand.
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

  /// Moves points out of planes at a communication point; velocities stay. Sets `moved` if there was any.
  StepStatus clear_jumps(const Body& body, const Drive& around, double time, Points& x, bool& moved);

  /// Before steps of size h from t0 on.
  void begin(const Drive& around, double t0, double h);

  /// Which points the free drift x1 = x0 + h v has taken behind a plane.
  void find(const StepView& step, const Points& x1);
  /// Then: corrects x1 and v of these. `before`: v before the kick.
  StepStatus drift(const StepView& step, const Points& before, Points& v, Points& x1, Exchange& exchange);

  /// After the closing half kick: corrects v of the points that the last drift corrected.
  StepStatus close(const StepView& step, Points& v, Exchange& exchange);

  /// The same, where the next opening half kick and its free drift x1 have been done without the correction: does them again for these
  /// points. So they are at hand for the drift after it, which need not look them up if it takes the same points behind the plane.
  StepStatus close_and_go_on(const StepView& step, Points& v, Points& x1, Exchange& exchange);

  bool touched() const { return !touched_.empty(); }
  /// Are they those that the drift before it touched, of one plane?
  bool same() const { return same_; }
  /// Of those a bit each, eight in a byte, plane by plane.
  const std::vector<unsigned char>& behind() const { return behind_; }
  /// The points that were found.
  const std::vector<int>& points() const { return touched_; }
  /// Impacts so far: points that came onto a plane, not those that stayed on one.
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

  std::vector<HalfSpace> start_, end_;        ///< the planes at a moment that is looked at, and at the end of the step
  std::vector<Approach> approach_;            ///< the planes during a step in which points touch
  std::vector<unsigned char> behind_, were_;  ///< by the last two drifts
  std::vector<int> touched_;                  ///< those of the last
  std::vector<Octet> octets_;                 ///< those of them that no pin holds, by plane, as many as ever were; the first so many:
  int used_ = 0;
  bool same_ = false;      ///< the points found are those of the last time
  bool at_hand_ = false;   ///< octets hold the step that has begun
  Count grouped_ = -1;     ///< version of the body of which octets hold the points that the last drift touched; -1: of none
  Octet unsettled_;        ///< before its closing correction
  std::vector<int> open_;  ///< (planes) octet that still has room
  std::vector<Constraint> constraints_;
  std::vector<int> active_;  ///< plane of each constraint
  FeasibleSet feasible_;
  Scalars gap_;
  std::vector<char> marked_;
  Count impacts_ = 0;
};

/// Number of control points on a half-space.
Count points_on(const HalfSpace& obstacle, double length, const Points& x);

}  // namespace softffd
