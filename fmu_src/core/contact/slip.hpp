/// How contacts slipped in one implicit step, summed over contacts with their loads as weights; and whether their states changed in it.
///
/// Backward Euler gives friction the direction that the slip has at the end of the step. Where a contact stops, turns round or begins to
/// slide within the step, friction is wrong until that event, and two steps of half the length are wrong by the same amount while the event
/// lies in the first of them. So step doubling does not see it, and the step has to end at the event.
#pragma once
#include <algorithm>

#include "model/types.hpp"

namespace softffd {

struct Slip {
  double load = 0;               ///< on contacts with friction [N]
  double spare = 0;              ///< friction that they could take before they slide [N]
  Vec3 friction = Vec3::Zero();  ///< on the body [N]
  double before = 0;             ///< slip at the beginning [N m/s]
  double along = 0;              ///< at the end, in the direction of the beginning [N m/s]
  double stopped = 0;            ///< at the beginning, of contacts that stick at the end or slide in another direction [N m/s]
  double loosened = 0;           ///< at the end, of contacts that stuck at the beginning [N m/s]
  double rigid = 0;              ///< the largest such slip of free obstacles, which nothing else stops sooner or later [m/s]

  /// One contact: the force that presses, the limit of friction and the friction [N], its slip at the beginning and the end [m/s]. change:
  /// of the obstacle's own velocity [m/s].
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
  /// The same of a free obstacle.
  void add_rigid(double limit, const Vec3& rub, const Vec3& begin, const Vec3& end, double change) {
    const double slid = begin.norm() - change, slides = end.norm();
    if (begins(rub.norm(), limit, slid, slides)) rigid = std::max(rigid, slides);
    if (slid > 0 && stops(slid, begin, end)) rigid = std::max(rigid, slid);
  }
  /// The next part of the same step.
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
  /// Cosine of the angle from which on a slip counts as turned round; of the other slip, what one that sticks may have; of the limit, what
  /// friction may lack of it where it slides [1].
  static constexpr double turned = 0.5, stuck = 1e-3, slack = 1e-3;
};

}  // namespace softffd
