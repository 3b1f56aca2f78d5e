#include "forces/springs.hpp"

#include <algorithm>
#include <limits>

namespace softffd {

namespace {

bool on_boundary(int i, int n) { return i == 0 || i == n - 1; }

/// An edge segment on one of the twelve edges of the box belongs to two faces: making springs face by face makes it twice.
double multiplicity(const Lattice& lattice, Topology topology, const Direction& d, int i, int j, int k) {
  if (!d.within(lattice, i, j, k)) return 0;
  if (topology == Topology::distinct || d.kind() != SpringKind::edge) return 1;
  const auto& n = lattice.counts;
  const bool across_x = d.di == 0 && on_boundary(i, n[0]), across_y = d.dj == 0 && on_boundary(j, n[1]);
  const bool across_z = d.dk == 0 && on_boundary(k, n[2]);
  return across_x + across_y + across_z == 2 ? 2 : 1;
}

Springs::Row make_row(const Lattice& lattice, Topology topology, const Direction& direction, const Points& rest) {
  const int offset = direction.offset(lattice), points = lattice.points();
  Scalars all = Scalars::Zero(points);
  for (int k = 0; k < lattice.counts[2]; ++k)
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i) all[lattice.index(i, j, k)] = multiplicity(lattice, topology, direction, i, j, k);
  int begin = 0, end = points - offset;
  while (all[begin] == 0) ++begin;
  while (all[end - 1] == 0) --end;
  const int lanes = end - begin;
  Springs::Row row{direction, begin, offset, all.segment(begin, lanes), Scalars::Zero(lanes), Scalars(lanes), {}};
  for (int p = 0; p < lanes; ++p) {
    const Vec3 d = softffd::row(rest, begin + p + offset) - softffd::row(rest, begin + p);
    row.rest_length[p] = std::sqrt(d.x() * d.x() + d.y() * d.y() + d.z() * d.z());  // the kernel's own expression: no force at rest
  }
  return row;
}

/// What a cell of modulus 1 gives to one spring of this direction [m].
double share_of_cell(const Lattice& lattice, const Direction& direction) {
  const Vec3 side = lattice.cell();
  const double volume = side.prod();
  const std::array<int, 3> steps{direction.di, direction.dj, direction.dk};
  double along = 0, across = 0;  // sums of 1 / side^2
  for (int axis = 0; axis < 3; ++axis) (steps[axis] != 0 ? along : across) += 1 / (side[axis] * side[axis]);
  if (direction.kind() == SpringKind::edge) return std::max(0.0, volume * (1.2 * along - 0.4 * across) / 4);
  return direction.kind() == SpringKind::face ? 0.2 * volume * along / 2 : 0;
}

/// The springs of one direction that a cell has: where they begin, as steps from the cell's lower corner.
struct OfCell {
  std::array<int, 4> begins;
  int count = 0;
  OfCell(const Lattice& lattice, const Direction& way) {
    for (int corner = 0; corner < 8; ++corner) {
      const int a = corner & 1, b = corner >> 1 & 1, c = corner >> 2;
      const bool begins_here =
          (way.di == 0 || a == (way.di < 0)) && (way.dj == 0 || b == (way.dj < 0)) && (way.dk == 0 || c == (way.dk < 0));
      if (begins_here) begins[count++] = lattice.index(a, b, c);
    }
  }
};

}  // namespace

double Springs::Row::overridden(int lane, double value, const std::vector<SpringOverride>& overrides) const {
  for (const SpringOverride& override : overrides)
    if (override.selected[begin + lane] && override.selected[begin + lane + offset]) value = override.value;
  return value;
}

Springs::Springs(const Lattice& lattice, Topology topology, std::shared_ptr<Team> team)
    : lattice_(lattice), pass_(lattice, std::move(team)), scratch_(6 * lattice.points()) {
  const Points rest = rest_positions(lattice);
  for (const Direction& direction : directions) rows_.push_back(make_row(lattice, topology, direction, rest));
}

void Springs::set_stiffness(const Stiffness& stiffness, const std::vector<SpringOverride>& overrides) {
  for (std::size_t d = 0; d < rows_.size(); ++d) {
    Row& row = rows_[d];
    for (int p = 0; p < row.lanes(); ++p)
      row.stiffness[p] = row.multiplicity[p] * row.overridden(p, stiffness.of(row.direction.kind()), overrides);
  }
  pass_.set(views());
}

void Springs::set_modulus(const Scalars& modulus, const Scalars& time) {
  const auto& n = lattice_.counts;
  const bool damped = (time > 0).any();
  for (std::size_t d = 0; d < rows_.size(); ++d) {
    Row& row = rows_[d];
    row.stiffness.setZero();
    row.dashpot.setZero(damped ? row.lanes() : 0);
    const OfCell springs(lattice_, row.direction);
    const double share = share_of_cell(lattice_, row.direction);
    int cell = 0;
    for (int k = 0; k + 1 < n[2]; ++k)
      for (int j = 0; j + 1 < n[1]; ++j)
        for (int i = 0; i + 1 < n[0]; ++i, ++cell)
          for (int s = 0; s < springs.count; ++s) {
            const int lane = lattice_.index(i, j, k) + springs.begins[s] - row.begin;
            row.stiffness[lane] += share * modulus[cell];
            if (damped) row.dashpot[lane] += share * modulus[cell] * time[cell];
          }
  }
  pass_.set(views());
  dashpots_changed();
}

void Springs::dashpots_changed() {
  longest_time_ = 0, shortest_time_ = std::numeric_limits<double>::infinity();
  for (const Row& row : rows_)
    for (int p = 0; p < row.lanes(); ++p) {
      if (row.stiffness[p] == 0) continue;
      const double time = row.dashpot.size() > 0 ? row.dashpot[p] / row.stiffness[p] : 0;
      longest_time_ = std::max(longest_time_, time);
      shortest_time_ = std::min(shortest_time_, time);
    }
  if (!dashpots()) return;
  std::array<const double*, directions.size()> c;
  for (std::size_t d = 0; d < c.size(); ++d) c[d] = rows_[d].dashpot.data();
  pass_.set_dashpots(views(), c);
}

SpringPass::Rows Springs::views() const {
  SpringPass::Rows views;
  for (std::size_t d = 0; d < views.size(); ++d) views[d] = rows_[d].view();
  return views;
}

void Springs::set_dashpots(double time, const std::vector<SpringOverride>& overrides) {
  const bool damped =
      time > 0 || std::any_of(overrides.begin(), overrides.end(), [](const SpringOverride& some) { return some.value > 0; });
  for (Row& row : rows_) {
    row.dashpot.resize(damped ? row.lanes() : 0);
    for (int p = 0; p < row.dashpot.size(); ++p) row.dashpot[p] = row.overridden(p, time, overrides) * row.stiffness[p];
  }
  dashpots_changed();
}

double Springs::energy(const Points& x) const {
  double energy = 0;
  for (const Row& row : rows_)
    for (int p = 0; p < row.lanes(); ++p) {
      const double stretch = (softffd::row(x, row.begin + p + row.offset) - softffd::row(x, row.begin + p)).norm() - row.rest_length[p];
      energy += 0.5 * row.stiffness[p] * stretch * stretch;
    }
  return energy;
}

int Springs::count() const {
  double count = 0;
  for (const Row& row : rows_) count += row.multiplicity.sum();
  return int(count);
}

}  // namespace softffd
