#include "forces/spring_pass.hpp"

#include <algorithm>
#include <utility>

#include "machine/lanes.hpp"

namespace softffd {

namespace {

constexpr int lanes = SpringPass::lanes;
constexpr std::size_t ways = directions.size();

constexpr std::ptrdiff_t whole_blocks(std::ptrdiff_t n) { return (n + lanes - 1) / lanes * lanes; }

/// Returns the distance from one ring to the next [numbers], an odd number of cache lines. It is known at compile time, which saves
/// address arithmetic.
constexpr std::ptrdiff_t stride(bool wraps) { return wraps ? whole_blocks(farthest_neighbour) + 4 * lanes : 21 * lanes; }

/// Smallest number of points of a part. Two threads take 0.75 of the time of one for 512 points, 0.6 for 1000, 0.55 for 4096.
constexpr int least_part = 512;
/// Time for a block of which only the springs are computed, relative to a block that is summed up too [1].
constexpr double lead_cost = 0.6;

}  // namespace

namespace kernels {

/// f(0), f(1) ... for all directions, written out one after the other.
template <class F>
INNER void each_way(F&& f) {
  [&]<std::size_t... d>(std::index_sequence<d...>) INLINED { (f(d), ...); }(std::make_index_sequence<ways>{});
}

/// Sets the part of the rings before the first point to 0, because no spring begins there.
template <int n>
INNER void clear(const SpringPass& pass, double* rings) {
  for (std::size_t row = 0; row < 3 * ways; ++row, rings += stride(true))
    for (std::ptrdiff_t i = 0; i < pass.before; i += n) store<n>(rings + i, Lanes<n>{});
}

/// Copies the tail of x to a place with room behind it. The last n numbers are copied first, so that whole registers suffice for all.
template <int n>
INNER void copy_tail(const SpringPass& pass, const double* x, double* end) {
  const std::ptrdiff_t size = pass.points - pass.tail;
  for (int c = 0; c < 3; ++c, end += pass.column) {
    const double* from = x + c * pass.points + pass.tail;
    store<n>(end + size - n, load<n>(from + size - n));
    for (std::ptrdiff_t i = 0; i + n <= size; i += n) store<n>(end + i, load<n>(from + i));
  }
}

/// Law of the springs: `pull` returns k (1 - l/r), the force per length of d.
struct Stretch {
  static constexpr int arrays = 1;
  const SpringKinds& kinds;
  std::array<const double*, arrays> from;  ///< positions
  template <int n>
  INLINED Lanes<n> pull(const SpringKinds::Material& material, int lane, const Triple<n>*, const Triple<n>& d) const {
    const Lanes<n> r = square_root<n>(d.x * d.x + d.y * d.y + d.z * d.z + smallest_square);
    return load<n>(material.stiffness + lane) * (1.0 - load<n>(material.rest_length + lane) / r);
  }
};

/// Law of the dashpots: `pull` returns the force per length of d, c times the mean rate of the length over the drift, by the length.
template <bool drifts>
struct Rate {
  static constexpr int arrays = 2;
  const SpringKinds& kinds;
  std::array<const double*, arrays> from;  ///< positions, velocities
  double drift;
  template <int n>
  INLINED Lanes<n> pull(const SpringKinds::Material& material, int lane, const Triple<n>* more, const Triple<n>& d) const {
    const Triple<n>& w = *more;
    const Lanes<n> inverse = 1.0 / (d.x * d.x + d.y * d.y + d.z * d.z + smallest_square);
    const Lanes<n> rate = (d.x * w.x + d.y * w.y + d.z * w.z) * inverse;
    if constexpr (!drifts) return load<n>(material.stiffness + lane) * rate;
    const Lanes<n> ax = w.x - rate * d.x, ay = w.y - rate * d.y, az = w.z - rate * d.z;  // across
    return load<n>(material.stiffness + lane) * (rate + 0.5 * drift * ((ax * ax + ay * ay + az * az) * inverse));
  }
};

/// Returns the vectors from points to their neighbours. The origin of the address is hidden from the compiler, which would else compute
/// the addresses of all directions and coordinates before a loop over registers of points, more than the processor keeps at hand.
template <int n>
INNER Triple<n> way(const double* to, std::ptrdiff_t column, const Triple<n>& from) {
  __asm__("" : "+r"(to));
  return {load<n>(to) - from.x, load<n>(to + column) - from.y, load<n>(to + 2 * column) - from.z};
}

/// Writes the forces on n points by the springs that begin there to the rings. x: the arrays of the law at these points.
template <int n, bool wraps, class Law>
INNER void give(const Law& law, const SpringPass::Offsets& offsets, const SpringKinds::Material* material, unsigned springs, int lane,
                const std::array<const double*, Law::arrays>& x, std::ptrdiff_t column, double* ring) {
  constexpr std::ptrdiff_t row = stride(wraps);
  Triple<n> here[Law::arrays], d[Law::arrays];
  for (int i = 0; i < Law::arrays; ++i) here[i] = load<n>(x[i] + lane, column);
  each_way([&](std::size_t w) INLINED {
    Lanes<n> sx{}, sy{}, sz{};
    if (springs >> w & 1) {
      for (int i = 0; i < Law::arrays; ++i) d[i] = way<n>(x[i] + lane + offsets[w], column, here[i]);
      const Lanes<n> pull = law.template pull<n>(material[w], lane, d + 1, d[0]);
      sx = pull * d[0].x, sy = pull * d[0].y, sz = pull * d[0].z;
      if constexpr (!wraps) store<n>(ring, row, {sx, sy, sz});
    }
    if constexpr (wraps) store<n>(ring, row, {sx, sy, sz});
    ring += 3 * row;
  });
}

/// Returns the places in the rings of the springs that end at the points from `slot` on. The places of a block are in one piece, because
/// a copy of a ring's first block stands behind its end.
template <bool wraps>
INNER SpringPass::Offsets ending(const SpringPass::Offsets& offsets, std::ptrdiff_t length, std::ptrdiff_t slot) {
  SpringPass::Offsets places;
  for (std::size_t d = 0; d < ways; ++d) {
    const std::ptrdiff_t back = slot - offsets[d];
    places[d] = wraps && back < 0 ? back + length : back;
  }
  return places;
}

/// Returns f plus the forces on n points of the block at `slot` in the rings: the forces by springs that begin at the points, less those
/// of springs that end there.
template <int n, bool wraps>
INNER Triple<n> take(const SpringPass::Offsets& ends, unsigned first, unsigned second, const double* rings, std::ptrdiff_t slot, int lane,
                     const Triple<n>& f) {
  constexpr std::ptrdiff_t row = stride(wraps);
  Lanes<n> fx = f.x, fy = f.y, fz = f.z;
  each_way([&](std::size_t d) INLINED {
    if (first >> d & 1) {
      const double* given = rings + slot + lane;
      fx += load<n>(given), fy += load<n>(given + row), fz += load<n>(given + 2 * row);
    }
    if (second >> d & 1) {
      const double* taken = rings + ends[d] + lane;
      fx -= load<n>(taken), fy -= load<n>(taken + row), fz -= load<n>(taken + 2 * row);
    }
    rings += 3 * row;
  });
  return {fx, fy, fz};
}

/// Copies the first block of each ring behind the ring's end.
template <int n>
INNER void copy_first(double* rings, std::ptrdiff_t length) {
  for (std::size_t row = 0; row < 3 * ways; ++row, rings += stride(true))
    for (int lane = 0; lane < lanes; lane += n) store<n>(rings + length + lane, load<n>(rings + lane));
}

/// Passes the forces of a part, added to the values of use.begin, to use.at, n points at a time, from the first to the last. The last
/// block of the lattice may have lanes behind the last point.
template <int n, bool wraps, class Law, class Use>
INNER void sweep(const SpringPass& pass, SpringPass::Part& part, const Law& law, const Use& use) {
  const SpringPass::Offsets offsets = pass.offsets;
  const std::ptrdiff_t length = pass.ring;
  double* rings = part.rings.front().of;
  std::array<const double*, Law::arrays> x, behind;

  if constexpr (wraps) clear<n>(pass, rings);
  for (int i = 0; i < Law::arrays; ++i) {
    double* end = part.behind[i].front().of + lanes;
    if (part.end * lanes > pass.tail) copy_tail<n>(pass, law.from[i], end);
    behind[i] = end;
  }
  const auto use_block = [&](int block, std::ptrdiff_t slot) INLINED {
    const SpringPass::Offsets ends = ending<wraps>(offsets, length, slot);
    for (int lane = 0; lane < lanes; lane += n) {
      const int p = block * lanes + lane;
      use.template at<n>(p, take<n, wraps>(ends, pass.first.at<n>(p), pass.second.at<n>(p), rings, slot, lane, use.template begin<n>(p)));
    }
  };
  std::ptrdiff_t slot = pass.before, before = 0, column = pass.points;
  const int past_tail = part.lead * lanes - pass.tail;
  for (int i = 0; i < Law::arrays; ++i) x[i] = past_tail > 0 ? behind[i] + past_tail : law.from[i] + part.lead * lanes;
  if (past_tail > 0) column = pass.column;
  for (int block = part.lead; block < part.end; ++block) {
    if (block * lanes == pass.tail) x = behind, column = pass.column;
    const SpringKinds::Material* material = law.kinds.of(block);
    for (int lane = 0; lane < lanes; lane += n)
      give<n, wraps>(law, offsets, material, pass.first.at<n>(block * lanes + lane), lane, x, column, rings + slot + lane);
    for (const double*& at : x) at += lanes;
    if (wraps && slot == 0) copy_first<n>(rings, length);
    if (block > part.begin) use_block(block - 1, before);
    before = slot;
    slot = wraps && slot + lanes == length ? 0 : slot + lanes;
  }
  use_block(part.end - 1, before);
}

/// Stores the forces in f.
struct Keep {
  int points;
  double* f;
  template <int n>
  INLINED Triple<n> begin(int) const {
    return {};
  }
  template <int n>
  INLINED void at(int p, const Triple<n>& force) const {
    if (p + n <= points) return store<n>(f + p, points, force);
    const int left = points - p;
    for (int i = 0; i < left; ++i) f[p + i] = force.x[i], f[points + p + i] = force.y[i], f[2 * points + p + i] = force.z[i];
  }
};

/// Adds the forces to those in f.
struct Add : Keep {
  template <int n>
  INLINED Triple<n> begin(int p) const {
    if (p + n <= points) return load<n>(f + p, points);
    Triple<n> there;
    for (int i = 0; i < points - p; ++i) there.x[i] = f[p + i], there.y[i] = f[points + p + i], there.z[i] = f[2 * points + p + i];
    return there;
  }
};

/// Moves the points by the forces, from velocities `before` to v. keeps: for some blocks the state between two kicks is stored. large:
/// values that are the same for all points are read at the first ones only; where little is read, the test costs more.
template <int kicks, bool keeps, bool large>
struct Move {
  int points;
  Stage stage;
  const double *outside, *x;
  double *before, *v, *next;
  SpringPass::Between between;
  template <int n>
  INLINED Triple<n> begin(int) const {
    return {};
  }
  template <int n>
  INLINED void at(int p, const Triple<n>& force) const {
    if (p + n > points) return at_the_end<n>(p, force);
    Lanes<n> a[kicks], b[kicks];
    for (int k = 0; k < kicks; ++k) {
      const int q = large && stage.kicks[k].even ? 0 : p;
      a[k] = load<n>(stage.kicks[k].a + q), b[k] = load<n>(stage.kicks[k].b + q);
    }
    const double* acting = outside + (large && stage.even_outside ? 0 : p);
    const bool kept = keeps && between.until[p / lanes] >= between.now;
    const auto move = [&](int column, const Lanes<n>& spring) INLINED {
      const int i = column + p;
      const Lanes<n> f = spring + load<n>(acting + column);
      Lanes<n> w = a[0] * load<n>(before + i) + b[0] * f;
      if (kept) store<n>(between.force + i, spring), store<n>(before + i, w);
      if constexpr (kicks > 1) w = a[1] * w + b[1] * f;
      store<n>(v + i, w);
      store<n>(next + i, load<n>(x + i) + stage.h * w);
    };
    move(0, force.x), move(points, force.y), move(2 * points, force.z);
  }
  /// The same where some lanes are behind the last point.
  template <int n>
  INLINED void at_the_end(int p, const Triple<n>& force) const {
    const Lanes<n> all[3] = {force.x, force.y, force.z};
    for (int c = 0; c < 3; ++c)
      for (int q = p; q < points; ++q) {
        const int i = c * points + q;
        const double f = all[c][q - p] + outside[i];
        double w = stage.kicks[0].a[q] * before[i] + stage.kicks[0].b[q] * f;
        if (keeps && between.until[q / lanes] >= between.now) between.force[i] = all[c][q - p], before[i] = w;
        if constexpr (kicks > 1) w = stage.kicks[1].a[q] * w + stage.kicks[1].b[q] * f;
        v[i] = w;
        next[i] = x[i] + stage.h * w;
      }
  }
};

template <int n, bool wraps>
INNER void force(const SpringPass& pass, SpringPass::Part& part, const double* x, double* f) {
  sweep<n, wraps>(pass, part, Stretch{pass.kinds, {x}}, Keep{pass.points, f});
}

template <int n, bool wraps>
INNER void add_dashpots(const SpringPass& pass, SpringPass::Part& part, const double* x, const double* v, double drift, double* f) {
  const Add add{{pass.points, f}};
  if (drift == 0)
    sweep<n, wraps>(pass, part, Rate<false>{*pass.dashpots, {x, v}, drift}, add);
  else
    sweep<n, wraps>(pass, part, Rate<true>{*pass.dashpots, {x, v}, drift}, add);
}

template <int n, bool wraps>
INNER void advance(const SpringPass& pass, SpringPass::Part& part, const Stage& stage, const double* outside, const double* x,
                   double* before, double* v, double* next, const SpringPass::Between& between) {
  const auto move = [&]<int kicks, bool keeps>() INLINED {
    sweep<n, wraps>(pass, part, Stretch{pass.kinds, {x}},
                    Move<kicks, keeps, wraps>{pass.points, stage, outside, x, before, v, next, between});
  };
  if (stage.count == 1)
    move.template operator()<1, false>();
  else if (between.until)
    move.template operator()<2, true>();
  else
    move.template operator()<2, false>();
}

const auto near_force = chosen<force<2, false>, force<4, false>, force<8, false>>();
const auto far_force = chosen<force<2, true>, force<4, true>, force<8, true>>();
const auto near_dashpots = chosen<add_dashpots<2, false>, add_dashpots<4, false>, add_dashpots<8, false>>();
const auto far_dashpots = chosen<add_dashpots<2, true>, add_dashpots<4, true>, add_dashpots<8, true>>();
const auto near_advance = chosen<advance<2, false>, advance<4, false>, advance<8, false>>();
const auto far_advance = chosen<advance<2, true>, advance<4, true>, advance<8, true>>();

}  // namespace kernels

int SpringPass::threads_of_use(const Lattice& lattice, int threads) { return std::clamp(lattice.points() / least_part, 1, threads); }

SpringPass::SpringPass(const Lattice& lattice, std::shared_ptr<Team> team)
    : points(lattice.points()),
      kinds(int(whole_blocks(points) / lanes)),
      first(int(whole_blocks(points))),
      second(first),
      team(std::move(team)) {
  for (std::size_t d = 0; d < ways; ++d) offsets[d] = directions[d].offset(lattice);
  const std::ptrdiff_t reach = *std::max_element(offsets.begin(), offsets.end()), blocks = whole_blocks(points) / lanes;
  before = whole_blocks(reach);
  wraps = before + whole_blocks(points) + lanes > stride(false);
  ring = wraps ? before + 2 * lanes : before + whole_blocks(points);
  tail = int(std::max<std::ptrdiff_t>(0, whole_blocks(points - lanes - reach + 1)));
  column = blocks * lanes - tail + whole_blocks(reach) + lanes;
  divide(int(blocks));
}

/// Divides the blocks so that each part takes equally long: all parts but the first also compute springs of blocks before them.
void SpringPass::divide(int blocks) {
  const int members = team ? std::min(team->members(), blocks) : 1, reach = int(before / lanes);
  const double more = lead_cost * std::min(reach, blocks / members), each = std::max(1.0, (blocks - more) / members);
  for (int part = 0; part < members; ++part) {
    const int begin = part == 0 ? 0 : parts.back().end, left = members - 1 - part;
    const int end = left == 0 ? blocks : std::clamp(int(more + each * (part + 1)), begin + 1, blocks - left);
    parts.push_back({std::max(0, begin - reach), begin, end, std::vector<Block>(3 * ways * stride(wraps) / lanes), {room()}});
  }
}

void SpringPass::set(const Rows& rows) {
  first.clear();
  second.clear();
  for (Part& part : parts) std::fill(part.rings.begin(), part.rings.end(), Block{});
  for (std::size_t d = 0; d < ways; ++d)
    for (int n = 0; n < rows[d].lanes; ++n) {
      if (!(rows[d].stiffness[n] > 0)) continue;
      first.add(rows[d].begin + n, 1u << d);
      second.add(rows[d].begin + n + rows[d].offset, 1u << d);
    }
  fill(kinds, [&](std::size_t d, int p, int lane, SpringKinds::Material& material) {
    const int n = p - rows[d].begin;
    if (n < 0 || n >= rows[d].lanes) return;
    material.stiffness[lane] = rows[d].stiffness[n];
    material.rest_length[lane] = rows[d].rest_length[n];
  });
}

void SpringPass::set_dashpots(const Rows& rows, const std::array<const double*, directions.size()>& c) {
  if (!dashpots) {
    dashpots.emplace(parts.back().end);
    for (Part& part : parts) part.behind[1] = room();
  }
  fill(*dashpots, [&](std::size_t d, int p, int lane, SpringKinds::Material& material) {
    const int n = p - rows[d].begin;
    if (n >= 0 && n < rows[d].lanes) material.stiffness[lane] = c[d][n];
  });
}

template <class Set>
void SpringPass::fill(SpringKinds& of, const Set& set) const {
  of.clear();
  for (int block = 0; block < parts.back().end; ++block) {
    SpringKinds::Kind kind;
    for (std::size_t d = 0; d < ways; ++d)
      for (int lane = 0; lane < lanes; ++lane) set(d, block * lanes + lane, lane, kind[d]);
    of.add(kind);
  }
}

template <class Act>
void SpringPass::each_part(const Act& act) const {
  if (!team) return act(parts.front());
  team->share([&](int member) {
    if (member < int(parts.size())) act(parts[member]);
  });
}

void SpringPass::force(const double* x, double* f) const {
  each_part([&](Part& part) { (wraps ? kernels::far_force : kernels::near_force)(*this, part, x, f); });
}

void SpringPass::add_dashpot_force(const double* x, const double* v, double drift, double* f) const {
  each_part([&](Part& part) { (wraps ? kernels::far_dashpots : kernels::near_dashpots)(*this, part, x, v, drift, f); });
}

void SpringPass::advance(const Stage& stage, const double* outside, const double* x, double* before, double* v, double* next,
                         const Between& between) const {
  each_part([&](Part& part) {
    (wraps ? kernels::far_advance : kernels::near_advance)(*this, part, stage, outside, x, before, v, next, between);
  });
}

}  // namespace softffd
