#include "contact/octet.hpp"

#include "machine/vectors.hpp"

namespace softffd {

namespace kernels {

template <int n>
INNER Triple<n> load(const Octet::Vector& v, int lane) {
  return {load<n>(v[0] + lane), load<n>(v[1] + lane), load<n>(v[2] + lane)};
}
template <int n>
INNER void store(Octet::Vector& to, int lane, const Triple<n>& v) {
  store<n>(to[0] + lane, v.x), store<n>(to[1] + lane, v.y), store<n>(to[2] + lane, v.z);
}
/// Loads numbers of the octet's points from an array of all points into lanes; `put` writes lanes back.
template <int n>
INNER Lanes<n> fetch(const Octet& octet, const double* from, int lane) {
  if (octet.whole()) return load<n>(from + octet.point[0] + lane);
  Lanes<n> each;
  for (int i = 0; i < n; ++i) each[i] = from[octet.point[lane + i]];
  return each;
}
template <int n>
INNER Triple<n> fetch(const Octet& octet, const Points& from, int lane) {
  const double* x = from.data();
  return {fetch<n>(octet, x, lane), fetch<n>(octet, x + from.rows(), lane), fetch<n>(octet, x + 2 * from.rows(), lane)};
}
template <int n>
INNER void put(const Octet& octet, int lane, const Triple<n>& v, Points& to) {
  if (octet.whole()) return store<n>(to.data() + octet.point[0] + lane, to.rows(), v);
  for (int i = 0; i < n && lane + i < octet.count; ++i) {
    double* at = to.data() + octet.point[lane + i];
    at[0] = v.x[i], at[to.rows()] = v.y[i], at[2 * to.rows()] = v.z[i];
  }
}
INNER Uniform uniform(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
template <int n>
INNER Lanes<n> positive(const Lanes<n>& a) {
  return a > 0.0 ? a : Lanes<n>{};
}

/// The functions of HalfSpace, lane by lane.
template <int n>
INNER Lanes<n> gap(const HalfSpace& plane, const Triple<n>& x) {
  return dot(uniform(plane.normal), x) - plane.offset;
}
template <int n>
INNER Triple<n> material_velocity(const HalfSpace& plane, const Triple<n>& x) {
  return uniform(plane.velocity) + cross(uniform(plane.spin), x - uniform(plane.point));
}
/// Returns the velocity of the plane's material at x; 0 if the plane is known to be at rest (`still`).
template <int n, bool still>
INNER Triple<n> surface_velocity(const HalfSpace& plane, const Triple<n>& x) {
  if constexpr (still) return {};
  return material_velocity(plane, x);
}
/// Returns the scalar product of that velocity with another vector; 0 if the plane is at rest.
template <int n, bool still, class Other>
INNER Lanes<n> with_surface(const Other& other, const Triple<n>& surface) {
  if constexpr (still) return Lanes<n>{};
  return dot(other, surface);
}
template <int n>
INNER Triple<n> tangential(const Uniform& normal, const Triple<n>& v) {
  return v - dot(normal, v) * normal;
}
template <int n, bool still>
INNER Triple<n> along_plane(const Uniform& normal, const Triple<n>& surface) {
  if constexpr (still) return {};
  return tangential(normal, surface);
}

/// Margin for rounding in a comparison of squares: a value below this multiple of the limit is below the limit without rounding too [1].
constexpr double surely = 1 - 1e-15;

/// Returns the slip after Coulomb friction of a normal impulse R: 0 if friction suffices to make the point stick; otherwise friction acts
/// against the mean of the slips before and after the kick. limit: mu R.
template <int n>
INNER Triple<n> after_friction(const Lanes<n>& limit, const Triple<n>& slip_before, const Triple<n>& slip_after) {
  constexpr unsigned every = (1u << n) - 1;
  const Lanes<n> square = dot(slip_after, slip_after);
  if (bits<n>(square <= surely * limit * limit) == every) return {};  // nearly always; saves the square root
  const Lanes<n> size = square_root<n>(square);
  const auto held = size <= limit;
  if (bits<n>(held) == every) return {};
  const Triple<n> mean = slip_before + slip_after;
  const Lanes<n> way = length(mean);
  const Triple<n> slides = choose(way > 0.0, slip_after - limit / way * mean, (1.0 - limit / size) * slip_after);
  return choose(held, Triple<n>{}, slides);
}

template <int n>
struct Corrected {
  Triple<n> x1, v, impulse;
};

/// Data that the two cases of contact have in common: a point that is on the plane (`stay`), and a point that arrives (`land`).
template <int n>
struct Meeting {
  const Approach& plane;
  Uniform normal;
  Triple<n> x0, v;      ///< v: velocity of the free drift
  Lanes<n> gap0, gap1;  ///< at both ends of the free drift
  Lanes<n> wall;        ///< normal velocity of the plane at the point
  Triple<n> wall_t;     ///< tangential velocity of the plane's surface
  Lanes<n> inertia;
};

template <int n>
INNER Triple<n> snapped(const HalfSpace& plane, const Triple<n>& x) {
  return x - gap(plane, x) * uniform(plane.normal);
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

/// Stores the impulse of the current correction on the plane and its torque.
template <int n>
INNER void note(const HalfSpace& plane, const Triple<n>& x1, const Triple<n>& impulse, int lane, Octet& octet) {
  const Triple<n> reaction = Triple<n>{} - impulse;
  store<n>(octet.impulse, lane, reaction);
  store<n>(octet.torque, lane, cross(x1 - uniform(plane.point), reaction));
}

template <int n, bool still>
INNER unsigned meet_plane(const Approach& plane, double touching, Octet& octet) {
  unsigned landed = 0, on = 0;
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    const Uniform normal = uniform(plane.end.normal);
    const Triple<n> x0 = load<n>(octet.x0, lane), v = load<n>(octet.v, lane);
    const Lanes<n> gap0 = gap(plane.start, x0), gap1 = gap(plane.end, load<n>(octet.x1, lane));
    const Meeting<n> meeting{plane,
                             normal,
                             x0,
                             v,
                             gap0,
                             gap1,
                             dot(normal, v) - (gap1 - gap0) / plane.h,
                             along_plane<n, still>(normal, surface_velocity<n, still>(plane.middle, x0 + 0.5 * plane.h * v)),
                             load<n>(octet.opening + lane)};
    Corrected<n> corrected = stay(meeting, load<n>(octet.before, lane));
    const auto there = gap0 > touching;
    const unsigned lands = bits<n>(there) & octet.all() >> lane;
    if (lands) {
      const Triple<n> acceleration = (load<n>(octet.force, lane) - load<n>(octet.damping + lane) * v) / load<n>(octet.mass + lane);
      const Corrected<n> other = land(meeting, acceleration);
      corrected = {choose(there, other.x1, corrected.x1), choose(there, other.v, corrected.v),
                   choose(there, other.impulse, corrected.impulse)};
    }
    landed |= lands << lane;
    on |= bits<n>(gap(plane.end, corrected.x1) <= touching) << lane;
    store<n>(octet.x1, lane, corrected.x1);
    store<n>(octet.v, lane, corrected.v);
    store<n>(octet.received, lane, corrected.impulse);
    store<n>(octet.work + lane, with_surface<n, still>(corrected.impulse, surface_velocity<n, still>(plane.end, corrected.x1)));
    note<n>(plane.end, corrected.x1, corrected.impulse, lane, octet);
  }
  octet.alone = on & octet.all();
  return landed;
}

template <int n>
INNER unsigned position_stage(const Approach& plane, double touching, Octet& octet) {
  return plane.still ? meet_plane<n, true>(plane, touching, octet) : meet_plane<n, false>(plane, touching, octet);
}

template <int n>
INNER void fetch_all(const Gathered& all, Octet& octet) {
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    store<n>(octet.mass + lane, fetch<n>(octet, all.mass, lane));
    store<n>(octet.damping + lane, fetch<n>(octet, all.damping, lane));
    store<n>(octet.opening + lane, fetch<n>(octet, all.opening, lane));
    store<n>(octet.closing + lane, fetch<n>(octet, all.closing, lane));
    store<n>(octet.keep + lane, fetch<n>(octet, all.keep, lane));
    store<n>(octet.gain + lane, fetch<n>(octet, all.gain, lane));
    store<n>(octet.x0, lane, fetch<n>(octet, all.x0, lane));
    store<n>(octet.before, lane, fetch<n>(octet, all.before, lane));
    store<n>(octet.force, lane, fetch<n>(octet, all.spring, lane) + fetch<n>(octet, all.outside, lane));
    store<n>(octet.x1, lane, fetch<n>(octet, all.x1, lane));
    store<n>(octet.v, lane, fetch<n>(octet, all.v, lane));
  }
}

template <int n>
INNER void put_both(const Octet& octet, Points& x1, Points& v) {
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    put<n>(octet, lane, load<n>(octet.x1, lane), x1);
    put<n>(octet, lane, load<n>(octet.v, lane), v);
  }
}

template <int n, bool still>
INNER void velocity_of_some(const Approach& plane, const Points& kicked, const Points& spring, const Points& outside, int lane,
                            Octet& octet) {
  const Uniform normal = uniform(plane.end.normal);
  const Triple<n> x1 = load<n>(octet.x1, lane), before = load<n>(octet.v, lane);
  const Triple<n> v = fetch<n>(octet, kicked, lane);
  store<n>(octet.spring, lane, fetch<n>(octet, spring, lane));
  store<n>(octet.outside, lane, fetch<n>(octet, outside, lane));
  const Triple<n> surface = surface_velocity<n, still>(plane.end, x1);
  const Lanes<n> reaction = positive<n>(with_surface<n, still>(normal, surface) - dot(normal, v));
  const Triple<n> slip = tangential(normal, v - surface);
  const Triple<n> unkicked = tangential(normal, before - surface);
  const Triple<n> left = after_friction<n>(plane.friction * reaction, unkicked, slip);
  const Triple<n> change = reaction * normal + (left - slip), impulse = load<n>(octet.closing + lane) * change;
  store<n>(octet.v, lane, v + change);
  store<n>(octet.received, lane, load<n>(octet.received, lane) + impulse);
  store<n>(octet.work + lane, load<n>(octet.work + lane) + with_surface<n, still>(impulse, surface));
  note<n>(plane.end, x1, impulse, lane, octet);
}

template <int n>
INNER void energy_of_some(double h, int lane, Octet& octet) {
  const Triple<n> force = 0.5 * (load<n>(octet.force, lane) + load<n>(octet.spring, lane) + load<n>(octet.outside, lane));
  const Triple<n> mean = 0.5 * (load<n>(octet.before, lane) + load<n>(octet.v, lane));
  const Triple<n> travel = load<n>(octet.x1, lane) - load<n>(octet.x0, lane);
  store<n>(octet.lost + lane, load<n>(octet.work + lane) - dot(load<n>(octet.received, lane), mean) - dot(force, h * mean - travel));
}

template <int n>
INNER void open_some(double h, int lane, Octet& octet) {
  const Triple<n> force = load<n>(octet.spring, lane) + load<n>(octet.outside, lane);
  const Triple<n> x0 = load<n>(octet.x1, lane), before = load<n>(octet.v, lane);
  const Triple<n> v = load<n>(octet.keep + lane) * before + load<n>(octet.gain + lane) * force;
  store<n>(octet.x0, lane, x0);
  store<n>(octet.before, lane, before);
  store<n>(octet.force, lane, force);
  store<n>(octet.v, lane, v);
  store<n>(octet.x1, lane, x0 + h * v);
}

template <int n>
INNER void velocity_stage(const Approach& plane, const Points& kicked, const Points& spring, const Points& outside, Octet& octet) {
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    if (plane.still)
      velocity_of_some<n, true>(plane, kicked, spring, outside, lane, octet);
    else
      velocity_of_some<n, false>(plane, kicked, spring, outside, lane, octet);
  }
}

template <int n>
INNER void account_energy(double h, Octet& octet, Points& v) {
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    energy_of_some<n>(h, lane, octet);
    put<n>(octet, lane, load<n>(octet.v, lane), v);
  }
}

template <int n>
INNER void open_step(double h, Octet& octet, Points& x1) {
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    open_some<n>(h, lane, octet);
    put<n>(octet, lane, load<n>(octet.x1, lane), x1);
  }
}

template <int n>
INNER void close_step(const Approach& plane, Points& v, const Points& spring, const Points& outside, Octet& octet) {
  velocity_stage<n>(plane, v, spring, outside, octet);
  account_energy<n>(plane.h, octet, v);
}

/// Does `velocity_stage`, `account_energy` and `open_step` for one register after the other. `put` comes last, so that until then all
/// values stay in registers.
template <int n, bool still>
INNER void close_and_open_from(const Approach& plane, Points& v, const Points& spring, const Points& outside, Octet& octet, Points& x1) {
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    velocity_of_some<n, still>(plane, v, spring, outside, lane, octet);
    energy_of_some<n>(plane.h, lane, octet);
    open_some<n>(plane.h, lane, octet);
    put<n>(octet, lane, load<n>(octet.before, lane), v);
    put<n>(octet, lane, load<n>(octet.x1, lane), x1);
  }
}

template <int n>
INNER void close_and_open(const Approach& plane, Points& v, const Points& spring, const Points& outside, Octet& octet, Points& x1) {
  if (plane.still) return close_and_open_from<n, true>(plane, v, spring, outside, octet, x1);
  close_and_open_from<n, false>(plane, v, spring, outside, octet, x1);
}

template <int n>
INNER Sides sides(const HalfSpace& plane, const Octet& octet, double bound) {
  Sides all{0, 0};
  for (int lane = 0; lane < Octet::lanes; lane += n) {
    const Lanes<n> gaps = gap(plane, load<n>(octet.x1, lane));
    all.at_least |= bits<n>(gaps >= bound) << lane;
    all.at_most |= bits<n>(gaps <= bound) << lane;
  }
  return all;
}

const auto fetch_here = chosen<fetch_all<2>, fetch_all<4>, fetch_all<8>>();
const auto position_stage_here = chosen<position_stage<2>, position_stage<4>, position_stage<8>>();
const auto put_here = chosen<put_both<2>, put_both<4>, put_both<8>>();
const auto velocity_stage_here = chosen<velocity_stage<2>, velocity_stage<4>, velocity_stage<8>>();
const auto account_energy_here = chosen<account_energy<2>, account_energy<4>, account_energy<8>>();
const auto close_step_here = chosen<close_step<2>, close_step<4>, close_step<8>>();
const auto close_and_open_here = chosen<close_and_open<2>, close_and_open<4>, close_and_open<8>>();
const auto open_step_here = chosen<open_step<2>, open_step<4>, open_step<8>>();
const auto sides_here = chosen<sides<2>, sides<4>, sides<8>>();

}  // namespace kernels

void fetch(const Gathered& all, Octet& octet) { kernels::fetch_here(all, octet); }
unsigned position_stage(const Approach& plane, double touching, Octet& octet) {
  return kernels::position_stage_here(plane, touching, octet);
}
void put(const Octet& octet, Points& x1, Points& v) { kernels::put_here(octet, x1, v); }
void velocity_stage(const Approach& plane, const Points& v, const Points& spring, const Points& outside, Octet& octet) {
  kernels::velocity_stage_here(plane, v, spring, outside, octet);
}
void account_energy(double h, Octet& octet, Points& v) { kernels::account_energy_here(h, octet, v); }
void close_step(const Approach& plane, Points& v, const Points& spring, const Points& outside, Octet& octet) {
  kernels::close_step_here(plane, v, spring, outside, octet);
}
void open_step(double h, Octet& octet, Points& x1) { kernels::open_step_here(h, octet, x1); }
void close_and_open(const Approach& plane, Points& v, const Points& spring, const Points& outside, Octet& octet, Points& x1) {
  kernels::close_and_open_here(plane, v, spring, outside, octet, x1);
}
Sides sides(const HalfSpace& plane, const Octet& octet, double gap) { return kernels::sides_here(plane, octet, gap); }

}  // namespace softffd
