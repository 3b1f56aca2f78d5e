/// Slip of contacts in one implicit step, summed over contacts with their loads as weights, and changes of their states within the step.
///
/// Backward Euler gives friction the direction that the slip has at the end of the step. If a contact stops, turns round or begins to
/// slide within the step, friction is wrong until that event, and two steps of half the length are wrong by the same amount if the event
/// lies in the first of them. Step doubling therefore does not detect this error, and the step has to end at the event.
#pragma once
#include <algorithm>

#include "model/types.hpp"

namespace softffd {

struct Slip {
  double load = 0;               ///< normal force on contacts with friction [N]
  double spare = 0;              ///< additional friction that the contacts could take before they slide [N]
  Vec3 friction = Vec3::Zero();  ///< friction force on the body [N]
  double before = 0;             ///< slip at the beginning of the step [N m/s]
  double along = 0;              ///< slip at the end, in the direction of the slip at the beginning [N m/s]
  double stopped = 0;            ///< slip at the beginning, of contacts that stick at the end or slide in another direction [N m/s]
  double loosened = 0;           ///< slip at the end, of contacts that stuck at the beginning [N m/s]
  double rigid = 0;  ///< largest such slip (stopped or loosened) of free obstacles, which nothing else stops sooner or later [m/s]

  /// Adds one contact. force, limit, rub: normal force, Coulomb limit and friction [N]; begin, end: slip at the beginning and at the end
  /// [m/s]; change: of the obstacle's own velocity in the step [m/s].
  void add_contact(double force, double limit, const Vec3& rub, const Vec3& begin, const Vec3& end, double change) {
    const double size = rub.norm(), slid = begin.norm() - change, slides = end.norm();
    load += force;
    spare += limit - size;
    friction += rub;
    if (begins(size, limit, slid, slides)) loosened += force * slides;
    if (!(slid > 0)) return;
    before += force * slid;
    along += force * begin.dot(end) / begin.norm();
    if (stops(slid, begin, end)) stopped += force * slid;
  }
  /// The same for a contact of a free obstacle.
  void add_rigid(double limit, const Vec3& rub, const Vec3& begin, const Vec3& end, double change) {
    const double slid = begin.norm() - change, slides = end.norm();
    if (begins(rub.norm(), limit, slid, slides)) rigid = std::max(rigid, slides);
    if (slid > 0 && stops(slid, begin, end)) rigid = std::max(rigid, slid);
  }
  /// Adds the next part of the same step.
  void add(const Slip& next) {
    const bool first = load == 0;
    load = next.load;
    spare = next.spare;
    friction = next.friction;
    if (first) before = next.before;
    along = next.along;
    stopped += next.stopped;
    loosened += next.loosened;
    rigid = std::max(rigid, next.rigid);
  }

 private:
  static bool begins(double rub, double limit, double slid, double slides) {
    return rub >= (1 - slack) * limit && !(slid > stuck * slides);
  }
  static bool stops(double slid, const Vec3& begin, const Vec3& end) {
    const double slides = end.norm();
    return slides < stuck * slid || begin.dot(end) < turned * begin.norm() * slides;
  }
  /// turned: a slip counts as turned round if the cosine of the angle is below this value. stuck: a contact counts as sticking at one end
  /// of the step if its slip there is below this fraction of the slip at the other end. slack: a contact counts as sliding if friction
  /// lacks at most this fraction of the limit [1].
  static constexpr double turned = 0.5, stuck = 1e-3, slack = 1e-3;
};

}  // namespace softffd
