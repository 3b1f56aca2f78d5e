#include "contact/octet.hpp"

#include "machine/vectors.hpp"

namespace softffd {

namespace kernels {

template <int n>
INNER Triple<n> load(const Octet::Vector& v, int lane) {
  return load<n>(v[0] + lane, Octet::lanes);
}
template <int n>
INNER void store(Octet::Vector& to, int lane, const Triple<n>& v) {
  store<n>(to[0] + lane, Octet::lanes, v);
}
template <int n>
INNER Triple<n> spread(const Vec3& v) {
  return {v.x() - Lanes<n>{}, v.y() - Lanes<n>{}, v.z() - Lanes<n>{}};
}
template <int n>
INNER Lanes<n> positive(const Lanes<n>& a) {
  return a > 0.0 ? a : Lanes<n>{};
}

/// HalfSpace, lane by lane.
template <int n>
INNER Lanes<n> gap(const HalfSpace& plane, const Triple<n>& x) {
  return dot(spread<n>(plane.normal), x) - plane.offset;
}
template <int n>
INNER Triple<n> material_velocity(const HalfSpace& plane, const Triple<n>& x) {
  return spread<n>(plane.velocity) + cross(spread<n>(plane.spin), x - spread<n>(plane.point));
}
template <int n>
INNER Triple<n> tangential(const Triple<n>& normal, const Triple<n>& v) {
  return v - dot(normal, v) * normal;
}

/// Coulomb friction of a normal impulse R on a point that slides: opposite to the mean slip, holding if it can. limit: mu R.
template <int n>
INNER Triple<n> after_friction(const Lanes<n>& limit, const Triple<n>& slip_before, const Triple<n>& slip_after) {
  const Lanes<n> size = length(slip_after);
  const Triple<n> mean = slip_before + slip_after;
  const Lanes<n> way = length(mean);
  const Triple<n> slides = choose(way > 0.0, slip_after - limit / way * mean, (1.0 - limit / size) * slip_after);
  return choose(size <= limit, Triple<n>{}, slides);
}

template <int n>
struct Corrected {
  Triple<n> x1, v, impulse;
};

/// What the two ways to meet a plane have in common.
template <int n>
struct Meeting {
  const Approach& plane;
  Triple<n> normal, x0, v;  ///< v: of the free drift
  Lanes<n> gap0, gap1;      ///< at both ends of the free drift
  Lanes<n> wall;            ///< normal velocity of the plane where the point is
  Triple<n> wall_t;         ///< tangential velocity of its surface
  Lanes<n> inertia;
};

template <int n>
INNER Triple<n> snapped(const HalfSpace& plane, const Triple<n>& x) {
  return x - gap(plane, x) * spread<n>(plane.normal);
}

template <int n>
INNER Corrected<n> stay(const Meeting<n>& m, const Triple<n>& before) {
  const Lanes<n> reaction = positive<n>(m.wall - dot(m.normal, m.v));
  const Triple<n> slip = tangential(m.normal, m.v) - m.wall_t;
  const Triple<n> left = after_friction<n>(m.plane.friction * reaction, tangential(m.normal, before) - m.wall_t, slip);
  const Triple<n> v = m.v + reaction * m.normal + (left - slip);
  return {snapped(m.plane.end, m.x0 + m.plane.h * v), v, m.inertia * (v - m.v)};
}

template <int n>
INNER Corrected<n> land(const Meeting<n>& m, const Triple<n>& acceleration) {
  const double h = m.plane.h;
  const Lanes<n> theta = m.gap0 / (m.gap0 - m.gap1);
  const Triple<n> ahead = (theta - 0.5) * h * acceleration, u = m.v + ahead;
  const Lanes<n> normal_speed = dot(m.normal, u), reaction = positive<n>(m.wall - normal_speed);
  const Triple<n> slip = tangential(m.normal, u) - m.wall_t;
  const Lanes<n> size = length(slip);
  const Triple<n> left = choose(size > 0.0, positive<n>(1.0 - m.plane.friction * reaction / size) * slip, slip);
  const Triple<n> v = (reaction > 0.0 ? m.wall : normal_speed) * m.normal + m.wall_t + left;
  const Triple<n> x1 = m.x0 + theta * h * m.v + (1.0 - theta) * h * (m.wall_t + left);
  return {snapped(m.plane.end, x1), v - ahead, m.inertia * (v - u)};
}

/// Stores the correction at hand; work: of the obstacle in it.
template <int n>
INNER Lanes<n> note(const HalfSpace& plane, const Triple<n>& x1, const Triple<n>& impulse, const Triple<n>& surface, int lane,
                    Octet& octet) {
  store<n>(octet.impulse, lane, impulse);
  store<n>(octet.torque, lane, cross(x1 - spread<n>(plane.point), Triple<n>{} - impulse));
  return dot(impulse, surface);
}

template <int n>
INNER unsigned meet(const Approach& plane, double touching, Octet& octet) {
  unsigned landed = 0;
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    const Triple<n> normal = spread<n>(plane.end.normal), x0 = load<n>(octet.x0, lane), v = load<n>(octet.v, lane);
    const Lanes<n> gap0 = gap(plane.start, x0), gap1 = gap(plane.end, load<n>(octet.x1, lane));
    const Meeting<n> meeting{plane,
                             normal,
                             x0,
                             v,
                             gap0,
                             gap1,
                             dot(normal, v) - (gap1 - gap0) / plane.h,
                             tangential(normal, material_velocity(plane.middle, x0 + 0.5 * plane.h * v)),
                             load<n>(octet.inertia + lane)};
    Corrected<n> corrected = stay(meeting, load<n>(octet.before, lane));
    unsigned lands = 0;
    for (int i = 0; i < n && lane + i < octet.count; ++i) lands |= unsigned(gap0[i] > touching) << i;
    if (lands) {
      const Triple<n> acceleration = (load<n>(octet.force, lane) - load<n>(octet.damping + lane) * v) / load<n>(octet.mass + lane);
      const Corrected<n> other = land(meeting, acceleration);
      const auto there = gap0 > touching;
      corrected = {choose(there, other.x1, corrected.x1), choose(there, other.v, corrected.v),
                   choose(there, other.impulse, corrected.impulse)};
    }
    landed |= lands << lane;
    store<n>(octet.x1, lane, corrected.x1);
    store<n>(octet.v, lane, corrected.v);
    store<n>(octet.received, lane, corrected.impulse);
    store<n>(octet.work + lane,
             note<n>(plane.end, corrected.x1, corrected.impulse, material_velocity(plane.end, corrected.x1), lane, octet));
  }
  return landed;
}

template <int n>
INNER void settle(const Approach& plane, Octet& octet) {
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    const Triple<n> normal = spread<n>(plane.end.normal), x1 = load<n>(octet.x1, lane), v = load<n>(octet.v, lane);
    const Triple<n> surface = material_velocity(plane.end, x1);
    const Lanes<n> reaction = positive<n>(dot(normal, surface) - dot(normal, v));
    const Triple<n> slip = tangential(normal, v - surface);
    const Triple<n> unkicked = tangential(normal, load<n>(octet.unkicked, lane) - surface);
    const Triple<n> left = after_friction<n>(plane.friction * reaction, unkicked, slip);
    const Triple<n> change = reaction * normal + (left - slip), impulse = load<n>(octet.inertia + lane) * change;
    store<n>(octet.v, lane, v + change);
    store<n>(octet.received, lane, load<n>(octet.received, lane) + impulse);
    store<n>(octet.work + lane, load<n>(octet.work + lane) + note<n>(plane.end, x1, impulse, surface, lane, octet));
  }
}

template <int n>
INNER void weigh(double h, const Octet& octet, double* lost) {
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    const Triple<n> mean = 0.5 * (load<n>(octet.before, lane) + load<n>(octet.v, lane));
    const Triple<n> travel = load<n>(octet.x1, lane) - load<n>(octet.x0, lane);
    store<n>(lost + lane,
             load<n>(octet.work + lane) - dot(load<n>(octet.received, lane), mean) - dot(load<n>(octet.force, lane), h * mean - travel));
  }
}

template <int n>
INNER void gaps_of(const HalfSpace& plane, const Octet& octet, double* gaps) {
  for (int lane = 0; lane < Octet::lanes; lane += n) store<n>(gaps + lane, gap(plane, load<n>(octet.x1, lane)));
}

const auto meet_here = chosen<meet<2>, meet<4>, meet<8>>();
const auto settle_here = chosen<settle<2>, settle<4>, settle<8>>();
const auto weigh_here = chosen<weigh<2>, weigh<4>, weigh<8>>();
const auto gaps_here = chosen<gaps_of<2>, gaps_of<4>, gaps_of<8>>();

}  // namespace kernels

unsigned meet(const Approach& plane, double touching, Octet& octet) { return kernels::meet_here(plane, touching, octet); }
void settle(const Approach& plane, Octet& octet) { kernels::settle_here(plane, octet); }
void weigh(double h, const Octet& octet, Octet::Number& lost) { kernels::weigh_here(h, octet, lost); }
void gaps_of(const HalfSpace& plane, const Octet& octet, Octet::Number& gaps) { kernels::gaps_here(plane, octet, gaps); }

}  // namespace softffd
