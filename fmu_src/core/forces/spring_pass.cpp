#include "forces/spring_pass.hpp"

#include <algorithm>
#include <utility>

#include "machine/lanes.hpp"

namespace softffd {

namespace {

constexpr int lanes = SpringPass::lanes;
constexpr std::size_t ways = directions.size();

constexpr std::ptrdiff_t whole_blocks(std::ptrdiff_t n) { return (n + lanes - 1) / lanes * lanes; }

/// From one ring to the next [numbers], known when it is compiled: that spares the addresses their arithmetic. An odd number of cache
/// lines.
constexpr std::ptrdiff_t stride(bool wraps) { return wraps ? whole_blocks(farthest_neighbour) + 4 * lanes : 21 * lanes; }

}  // namespace

namespace kernels {

/// f(0), f(1) ... for all directions, written out one after the other.
template <class F, std::size_t... d>
INNER void each(std::index_sequence<d...>, F&& f) {
  (f(d), ...);
}
template <class F>
INNER void each_way(F&& f) {
  each(std::make_index_sequence<ways>{}, f);
}

/// What is before the first point gives nothing.
template <int n>
INNER void clear(const SpringPass& pass, double* rings) {
  for (std::size_t row = 0; row < 3 * ways; ++row, rings += stride(true))
    for (std::ptrdiff_t i = 0; i < pass.before; i += n) store<n>(rings + i, Lanes<n>{});
}

/// The tail of x goes where there is room behind it. The last numbers are copied first, with some before them: whole registers do.
template <int n>
INNER void copy_tail(const SpringPass& pass, const double* x, double* end) {
  const std::ptrdiff_t size = pass.points - pass.tail;
  for (int c = 0; c < 3; ++c, end += pass.column) {
    const double* from = x + c * pass.points + pass.tail;
    store<n>(end + size - n, load<n>(from + size - n));
    for (std::ptrdiff_t i = 0; i + n <= size; i += n) store<n>(end + i, load<n>(from + i));
  }
}

/// What the springs of n points give these goes to the rings.
template <int n, bool wraps>
INNER void give(const SpringPass::Offsets& offsets, const SpringPass::Material* material, unsigned springs, int lane, const double* x,
                std::ptrdiff_t column, double* ring) {
  constexpr std::ptrdiff_t row = stride(wraps);
  const double *y = x + column, *z = y + column;
  const Lanes<n> x0 = load<n>(x), y0 = load<n>(y), z0 = load<n>(z);
  each_way([&](std::size_t d) INLINED {
    Lanes<n> sx{}, sy{}, sz{};
    if (springs >> d & 1) {
      const std::ptrdiff_t o = offsets[d];
      const Lanes<n> dx = load<n>(x + o) - x0, dy = load<n>(y + o) - y0, dz = load<n>(z + o) - z0;
      const Lanes<n> r = square_root<n>(dx * dx + dy * dy + dz * dz + smallest_square);
      const Lanes<n> pull = load<n>(material[d].stiffness + lane) * (1.0 - load<n>(material[d].rest_length + lane) / r);
      sx = pull * dx, sy = pull * dy, sz = pull * dz;
      if constexpr (!wraps) store<n>(ring, row, {sx, sy, sz});
    }
    if constexpr (wraps) store<n>(ring, row, {sx, sy, sz});
    ring += 3 * row;
  });
}

/// The forces on the n points at `slot` in the rings: what their springs give them less what they give the springs that end there.
template <int n, bool wraps>
INNER Triple<n> take(const SpringPass::Offsets& offsets, unsigned first, unsigned second, std::ptrdiff_t length, const double* rings,
                     std::ptrdiff_t slot) {
  constexpr std::ptrdiff_t row = stride(wraps);
  Lanes<n> fx{}, fy{}, fz{};
  each_way([&](std::size_t d) INLINED {
    if (first >> d & 1) {
      const double* given = rings + slot;
      fx += load<n>(given), fy += load<n>(given + row), fz += load<n>(given + 2 * row);
    }
    if (second >> d & 1) {
      const std::ptrdiff_t back = slot - offsets[d];
      const double* taken = rings + (wraps && back < 0 ? back + length : back);
      fx -= load<n>(taken), fy -= load<n>(taken + row), fz -= load<n>(taken + 2 * row);
    }
    rings += 3 * row;
  });
  return {fx, fy, fz};
}

/// The first block of a ring once more behind its end.
template <int n>
INNER void copy_first(double* rings, std::ptrdiff_t length) {
  for (std::size_t row = 0; row < 3 * ways; ++row, rings += stride(true))
    for (int lane = 0; lane < lanes; lane += n) store<n>(rings + length + lane, load<n>(rings + lane));
}

/// Hands the forces to use.at, n points at a time, from the first to the last; the last block may have lanes behind the last point.
template <int n, bool wraps, class Use>
INNER void sweep(const SpringPass& pass, const double* x, const Use& use) {
  const SpringPass::Offsets offsets = pass.offsets;
  const std::ptrdiff_t length = pass.ring;
  double *rings = pass.rings.front().of, *end = pass.end.front().of + lanes;

  if constexpr (wraps) clear<n>(pass, rings);
  copy_tail<n>(pass, x, end);
  const auto use_block = [&](int block, std::ptrdiff_t slot) INLINED {
    for (int lane = 0; lane < lanes; lane += n)
      use.template at<n>(block * lanes + lane, take<n, wraps>(offsets, pass.first[block], pass.second[block], length, rings, slot + lane));
  };
  std::ptrdiff_t slot = pass.before, before = 0, column = pass.points;
  const SpringPass::Material* material = pass.material.data();
  const int blocks = int(pass.first.size());
  for (int block = 0; block < blocks; ++block, x += lanes, material += ways) {
    if (block * lanes == pass.tail) x = end, column = pass.column;
    for (int lane = 0; lane < lanes; lane += n)
      give<n, wraps>(offsets, material, pass.first[block], lane, x + lane, column, rings + slot + lane);
    if (wraps && slot == 0) copy_first<n>(rings, length);
    if (block > 0) use_block(block - 1, before);
    before = slot;
    slot = wraps && slot + lanes == length ? 0 : slot + lanes;
  }
  use_block(blocks - 1, before);
}

/// Forces that are kept.
struct Keep {
  int points;
  double* f;
  template <int n>
  INLINED void at(int p, const Triple<n>& force) const {
    if (p + n <= points) return store<n>(f + p, points, force);
    const int left = points - p;
    for (int i = 0; i < left; ++i) f[p + i] = force.x[i], f[points + p + i] = force.y[i], f[2 * points + p + i] = force.z[i];
  }
};

/// Forces that move the points.
template <int kicks>
struct Move {
  int points;
  Stage stage;
  const double *outside, *x;
  double *v, *next;
  template <int n>
  INLINED void at(int p, const Triple<n>& force) const {
    const Lanes<n> all[3] = {force.x, force.y, force.z};
    if (p + n <= points) {
      Lanes<n> a[kicks], b[kicks];
      for (int k = 0; k < kicks; ++k) a[k] = load<n>(stage.kicks[k].a + p), b[k] = load<n>(stage.kicks[k].b + p);
      for (int c = 0; c < 3; ++c) {
        const int i = c * points + p;
        const Lanes<n> f = all[c] + load<n>(outside + i);
        Lanes<n> w = load<n>(v + i);
        for (int k = 0; k < kicks; ++k) w = a[k] * w + b[k] * f;
        store<n>(v + i, w);
        store<n>(next + i, load<n>(x + i) + stage.h * w);
      }
      return;
    }
    for (int c = 0; c < 3; ++c)
      for (int q = p; q < points; ++q) {
        const int i = c * points + q;
        const double f = all[c][q - p] + outside[i];
        for (int k = 0; k < kicks; ++k) v[i] = stage.kicks[k].a[q] * v[i] + stage.kicks[k].b[q] * f;
        next[i] = x[i] + stage.h * v[i];
      }
  }
};

template <int n, bool wraps>
INNER void force(const SpringPass& pass, const double* x, double* f) {
  sweep<n, wraps>(pass, x, Keep{pass.points, f});
}

template <int n, bool wraps>
INNER void advance(const SpringPass& pass, const Stage& stage, const double* outside, const double* x, double* v, double* next) {
  if (stage.count == 1)
    sweep<n, wraps>(pass, x, Move<1>{pass.points, stage, outside, x, v, next});
  else
    sweep<n, wraps>(pass, x, Move<2>{pass.points, stage, outside, x, v, next});
}

const auto near_force = chosen<force<2, false>, force<4, false>, force<8, false>>();
const auto far_force = chosen<force<2, true>, force<4, true>, force<8, true>>();
const auto near_advance = chosen<advance<2, false>, advance<4, false>, advance<8, false>>();
const auto far_advance = chosen<advance<2, true>, advance<4, true>, advance<8, true>>();

}  // namespace kernels

SpringPass::SpringPass(const Lattice& lattice) : points(lattice.points()) {
  for (std::size_t d = 0; d < ways; ++d) offsets[d] = directions[d].offset(lattice);
  const std::ptrdiff_t reach = *std::max_element(offsets.begin(), offsets.end()), blocks = whole_blocks(points) / lanes;
  before = whole_blocks(reach);
  wraps = before + whole_blocks(points) + lanes > stride(false);
  ring = wraps ? before + 2 * lanes : before + whole_blocks(points);
  tail = int(std::max<std::ptrdiff_t>(0, whole_blocks(points - lanes - reach + 1)));
  column = blocks * lanes - tail + whole_blocks(reach) + lanes;
  material.resize(blocks * ways);
  first.resize(blocks);
  second.resize(blocks);
  rings.resize(3 * ways * stride(wraps) / lanes);
  end.resize(3 * column / lanes + 1);
}

void SpringPass::set(std::size_t direction, const kernels::SpringRow& row) {
  const unsigned bit = 1u << direction;
  for (auto* bits : {&first, &second})
    for (unsigned& block : *bits) block &= ~bit;
  const auto ring = rings.begin() + 3 * direction * stride(wraps) / lanes;
  std::fill(ring, ring + 3 * stride(wraps) / lanes, Block{});
  for (int n = 0; n < row.lanes; ++n) {
    const int p = row.begin + n, block = p / lanes, lane = p % lanes;
    Material& of = material[block * ways + direction];
    of.stiffness[lane] = row.stiffness[n];
    of.rest_length[lane] = row.rest_length[n];
    if (row.stiffness[n] > 0) first[block] |= bit, second[(p + row.offset) / lanes] |= bit;
  }
}

void SpringPass::force(const double* x, double* f) const { (wraps ? kernels::far_force : kernels::near_force)(*this, x, f); }

void SpringPass::advance(const Stage& stage, const double* outside, const double* x, double* v, double* next) const {
  (wraps ? kernels::far_advance : kernels::near_advance)(*this, stage, outside, x, v, next);
}

}  // namespace softffd
