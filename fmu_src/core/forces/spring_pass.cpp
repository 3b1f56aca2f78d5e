#include "forces/spring_pass.hpp"

#include <algorithm>

#include "machine/lanes.hpp"

namespace softffd {

namespace {

constexpr int lanes = SpringPass::lanes;
constexpr std::size_t ways = directions.size();

std::ptrdiff_t whole_blocks(std::ptrdiff_t n) { return (n + lanes - 1) / lanes * lanes; }

}  // namespace

namespace kernels {

/// What is before the first point gives nothing.
template <int n>
INNER void clear(const SpringPass& pass, double* rings, std::ptrdiff_t stride) {
  for (std::size_t d = 0; d < ways; ++d, rings += 3 * stride)
    for (std::ptrdiff_t i = pass.ring - n; i > pass.ring - n - pass.offsets[d]; i -= n) store<n>(rings + i, stride, {});
}

/// What the springs of n points give these goes to the rings. first: at their beginning, of which a copy stands behind their end.
template <int n>
INNER void give(const SpringPass::Offsets& offsets, std::ptrdiff_t length, const SpringPass::Material* material, unsigned springs, int lane,
                const double* x, std::ptrdiff_t column, double* ring, std::ptrdiff_t stride, bool first) {
  const Lanes<n> x0 = load<n>(x), y0 = load<n>(x + column), z0 = load<n>(x + 2 * column);
  for (std::size_t d = 0; d < ways; ++d, ring += 3 * stride) {
    Lanes<n> sx{}, sy{}, sz{};
    if (springs >> d & 1) {
      const double* there = x + offsets[d];
      const Lanes<n> dx = load<n>(there) - x0, dy = load<n>(there + column) - y0, dz = load<n>(there + 2 * column) - z0;
      const Lanes<n> r = square_root<n>(dx * dx + dy * dy + dz * dz + smallest_square);
      const Lanes<n> pull = load<n>(material[d].stiffness + lane) * (1.0 - load<n>(material[d].rest_length + lane) / r);
      sx = pull * dx, sy = pull * dy, sz = pull * dz;
    }
    store<n>(ring, stride, {sx, sy, sz});
    if (first) store<n>(ring + length, stride, {sx, sy, sz});
  }
}

/// The forces on the n points at `slot` in the rings: what their springs give them less what they give the springs that end there.
template <int n>
INNER Triple<n> take(const SpringPass::Offsets& offsets, std::ptrdiff_t length, const double* rings, std::ptrdiff_t stride,
                     std::ptrdiff_t slot) {
  Lanes<n> fx{}, fy{}, fz{};
  for (std::size_t d = 0; d < ways; ++d, rings += 3 * stride) {
    const std::ptrdiff_t back = slot - offsets[d];
    const double *given = rings + slot, *taken = rings + (back < 0 ? back + length : back);
    fx += load<n>(given), fy += load<n>(given + stride), fz += load<n>(given + 2 * stride);
    fx -= load<n>(taken), fy -= load<n>(taken + stride), fz -= load<n>(taken + 2 * stride);
  }
  return {fx, fy, fz};
}

/// n: points at a time, of which a block holds a whole number.
template <int n>
INNER void add_up(const SpringPass& pass, const double* x, double* f) {
  const int points = pass.points, last = (points - 1) / lanes * lanes;
  const SpringPass::Offsets offsets = pass.offsets;
  const std::ptrdiff_t length = pass.ring, stride = length + lanes;
  double *rings = pass.rings.front().of, *end = pass.end.front().of;
  clear<n>(pass, rings, stride);
  for (int c = 0; c < 3; ++c) std::memcpy(end + c * pass.column, x + c * points + pass.tail, (points - pass.tail) * sizeof(double));
  std::ptrdiff_t slot = 0, before = 0, column = points;
  const SpringPass::Material* material = pass.material.data();
  for (int a = 0; a < points; a += lanes, x += lanes, material += ways) {
    if (a == pass.tail) x = end, column = pass.column;
    const unsigned springs = pass.springs[a / lanes];
    for (int lane = 0; lane < lanes; lane += n) {
      give<n>(offsets, length, material, springs, lane, x + lane, column, rings + slot + lane, stride, slot == 0);
      if (a > 0) store<n>(f + a - lanes + lane, points, take<n>(offsets, length, rings, stride, before + lane));
    }
    before = slot;
    slot = slot + lanes == length ? 0 : slot + lanes;
  }
  double forces[3][lanes];
  for (int lane = 0; lane < lanes; lane += n) store<n>(forces[0] + lane, lanes, take<n>(offsets, length, rings, stride, before + lane));
  for (int c = 0; c < 3; ++c) std::memcpy(f + c * points + last, forces[c], (points - last) * sizeof(double));
}

const auto add_up_here = chosen<add_up<2>, add_up<4>, add_up<8>>();

}  // namespace kernels

SpringPass::SpringPass(const Lattice& lattice) : points(lattice.points()) {
  for (std::size_t d = 0; d < ways; ++d) offsets[d] = directions[d].offset(lattice);
  const std::ptrdiff_t reach = *std::max_element(offsets.begin(), offsets.end()), blocks = whole_blocks(points) / lanes;
  ring = whole_blocks(reach) + 2 * lanes;
  tail = int(std::max<std::ptrdiff_t>(0, whole_blocks(points - lanes - reach + 1)));
  column = blocks * lanes - tail + whole_blocks(reach);
  material.resize(blocks * ways);
  springs.resize(blocks);
  rings.resize(3 * ways * (ring / lanes + 1));
  end.resize(3 * column / lanes);
}

void SpringPass::set(std::size_t direction, const kernels::SpringRow& row) {
  const unsigned bit = 1u << direction;
  for (unsigned& block : springs) block &= ~bit;
  for (int n = 0; n < row.lanes; ++n) {
    const int block = (row.begin + n) / lanes, lane = (row.begin + n) % lanes;
    Material& of = material[block * ways + direction];
    of.stiffness[lane] = row.stiffness[n];
    of.rest_length[lane] = row.rest_length[n];
    if (row.stiffness[n] > 0) springs[block] |= bit;
  }
}

void SpringPass::force(const double* x, double* f) const { kernels::add_up_here(*this, x, f); }

}  // namespace softffd
