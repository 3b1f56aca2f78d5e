#include "forces/springs.hpp"

#include <algorithm>

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
  Springs::Row row{direction, begin, offset, all.segment(begin, lanes), Scalars::Zero(lanes), Scalars(lanes), Scalars::Zero(lanes)};
  for (int p = 0; p < lanes; ++p) {
    const Vec3 d = softffd::row(rest, begin + p + offset) - softffd::row(rest, begin + p);
    row.rest_length[p] = std::sqrt(d.x() * d.x() + d.y() * d.y() + d.z() * d.z());  // the kernel's own expression: no force at rest
  }
  return row;
}

}  // namespace

Springs::Springs(const Lattice& lattice, Topology topology) : pass_(lattice), scratch_(6 * lattice.points()) {
  const Points rest = rest_positions(lattice);
  for (const Direction& direction : directions) rows_.push_back(make_row(lattice, topology, direction, rest));
}

void Springs::set_stiffness(const Stiffness& stiffness, const std::vector<StiffnessOverride>& overrides) {
  for (std::size_t d = 0; d < rows_.size(); ++d) {
    Row& row = rows_[d];
    for (int p = 0; p < row.lanes(); ++p) {
      double k = stiffness.of(row.direction.kind());
      for (const auto& override : overrides)
        if (override.selected[row.begin + p] && override.selected[row.begin + p + row.offset]) k = override.stiffness;
      row.stiffness[p] = row.multiplicity[p] * k;
    }
    pass_.set(d, row.view());
  }
}

void Springs::set_dashpots(double time) {
  longest_time_ = 0;
  for (Row& row : rows_)
    for (int p = 0; p < row.lanes(); ++p) {
      row.dashpot[p] = time * row.stiffness[p];
      if (row.dashpot[p] > 0) longest_time_ = std::max(longest_time_, time);
    }
}

void Springs::add_dashpot_force(const Points& x, const Points& v, Points& f) const {
  for (const Row& row : rows_)
    kernels::add_dashpot_force(row.view(), int(x.rows()), x.data(), v.data(), row.dashpot.data(), f.data(), scratch_.data());
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
