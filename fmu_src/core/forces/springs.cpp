#include "forces/springs.hpp"

#include <algorithm>
#include <limits>

namespace softffd {

namespace {

bool on_boundary(int i, int n) { return i == 0 || i == n - 1; }

/// Returns how often a spring exists. An edge segment on one of the twelve edges of the box belongs to two faces: making springs face by
/// face makes it twice.
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
    row.rest_length[p] = std::sqrt(d.x() * d.x() + d.y() * d.y() + d.z() * d.z());  // as the kernel computes it: no force at rest
  }
  return row;
}

/// Returns the contribution of a cell of modulus 1 to one spring of this direction [m].
double fraction_of_cell(const Lattice& lattice, const Direction& direction) {
  const Vec3 side = lattice.cell();
  const double volume = side.prod();
  const std::array<int, 3> steps{direction.di, direction.dj, direction.dk};
  double along = 0, across = 0;  // sums of 1 / side^2
  for (int axis = 0; axis < 3; ++axis) (steps[axis] != 0 ? along : across) += 1 / (side[axis] * side[axis]);
  if (direction.kind() == SpringKind::edge) return std::max(0.0, volume * (1.2 * along - 0.4 * across) / 4);
  return direction.kind() == SpringKind::face ? 0.2 * volume * along / 2 : 0;
}

/// The springs of one direction in a cell: where they begin, as index offsets from the cell's lower corner.
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
    : lattice_(lattice), pass_(lattice, std::move(team)), block_(6 * lattice.points()), sums_(6 * lattice.points()) {
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
    const double fraction = fraction_of_cell(lattice_, row.direction);
    int cell = 0;
    for (int k = 0; k + 1 < n[2]; ++k)
      for (int j = 0; j + 1 < n[1]; ++j)
        for (int i = 0; i + 1 < n[0]; ++i, ++cell)
          for (int s = 0; s < springs.count; ++s) {
            const int lane = lattice_.index(i, j, k) + springs.begins[s] - row.begin;
            row.stiffness[lane] += fraction * modulus[cell];
            if (damped) row.dashpot[lane] += fraction * modulus[cell] * time[cell];
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

void Springs::add_force(const Points& x, Points& f) const {
  pass_.force(x.data(), sums_.data());
  f += Eigen::Map<const Points>(sums_.data(), f.rows(), 3);
}

void Springs::add_blocks(const Points& x, const Linearisation& of, BlockSink& sink) const {
  const int n = int(x.rows());
  const auto block = [](const Scalars& from, int stride, int lane, double sign) {
    Mat3 made;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) made(a, b) = sign * from[component[a][b] * stride + lane];
    return made;
  };
  sums_.setZero();
  for (const Row& row : rows_) {
    kernels::add_spring_matrices(row.view(), dashpots_of(row), n, x.data(), of.softening, dashpots() ? of.per_time : 0, block_.data(),
                                 sums_.data());
    for (int lane = 0, p = row.begin; lane < row.lanes(); ++lane, ++p)
      if (row.stiffness[lane] > 0) sink.add(p, p + row.offset, block(block_, row.lanes(), lane, -1));
  }
  for (int p = 0; p < n; ++p) sink.add(p, p, block(sums_, n, p, 1));
}

void Springs::subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const {
  for (const Row& row : rows_)
    kernels::subtract_spring_products(row.view(), dashpots_of(row), int(x.rows()), x.data(), of.softening, dashpots() ? of.per_time : 0,
                                      u.data(), f.data(), block_.data());
}

double Springs::largest_stiffness() const {
  double largest = 0;
  for (const Row& row : rows_) largest = std::max(largest, kernels::largest(row.stiffness.size(), row.stiffness.data()));
  return largest;
}

double Springs::total_stiffness() const {
  double total = 0;
  for (const Row& row : rows_) total += row.stiffness.sum();
  return total;
}

void Springs::add_any_bounds(const Scalars& mass, const std::vector<bool>& pinned, AnyBounds& bounds) const {
  const auto weight = [&](double k, int here, int there) {  // a pinned end is infinitely heavy
    if (pinned[here]) return 0.0;
    return pinned[there] ? k : k * (1 + std::sqrt(mass[here] / mass[there]));
  };
  for (std::size_t d = 0; d < rows_.size(); ++d) {
    const Row& row = rows_[d];
    first_[d].resize(row.lanes());
    second_[d].resize(row.lanes());
    for (int lane = 0; lane < row.lanes(); ++lane) {
      const int p = row.begin + lane, q = p + row.offset;
      const double k = row.stiffness[lane];
      first_[d][lane] = weight(k, p, q);
      second_[d][lane] = weight(k, q, p);
      bounds.weighted[p] += first_[d][lane];
      bounds.weighted[q] += second_[d][lane];
      bounds.plain[p] += pinned[p] ? 0 : 2 * k;
      bounds.plain[q] += pinned[q] ? 0 : 2 * k;
    }
  }
}

bool Springs::add_bounds(const Points& x, const Scalars&, const std::vector<bool>&, Scalars& sums) const {
  for (std::size_t d = 0; d < rows_.size(); ++d)
    kernels::add_stiffness_bounds(rows_[d].view(), int(x.rows()), x.data(), first_[d].data(), second_[d].data(), sums.data(),
                                  block_.data());
  return false;
}

bool Springs::has_deformed(const Points& x, const Points& x0) const {
  for (const Row& row : rows_) {
    if (row.direction.kind() != SpringKind::edge) break;
    const double limit = deformation * row.rest_length[0];
    if (!(kernels::largest_change(row.view(), int(x.rows()), x.data(), x0.data()) <= limit * limit)) return true;
  }
  return false;
}

double Springs::swing(const Points& x, const Points& v, const Swing& by) const {
  LargestSwing largest(by);
  for (const Row& springs : rows_)
    for (int lane = 0; lane < springs.lanes(); ++lane)
      if (const int p = springs.begin + lane; springs.stiffness[lane] != 0)
        largest.consider(p, p + springs.offset, springs.rest_length[lane], x, v);
  return largest.value();
}

bool Springs::undecided(const Points& x, const Points& v, const std::vector<bool>& pinned) const {
  for (const Row& springs : rows_)
    for (int lane = 0; lane < springs.lanes(); ++lane) {
      const int p = springs.begin + lane, q = p + springs.offset;
      const bool apart = row(x, p) != row(x, q) || row(v, p) != row(v, q);
      if (!apart && springs.stiffness[lane] > 0 && !(pinned[p] && pinned[q])) return true;
    }
  return false;
}

double Springs::dashpot_power(const Points& x, const Points& v) const {
  double power = 0;
  if (!dashpots()) return power;
  for (const Row& row : rows_)
    for (int lane = 0; lane < row.lanes(); ++lane) {
      if (row.dashpot[lane] == 0) continue;
      const int p = row.begin + lane, q = p + row.offset;
      double along = 0, squared = kernels::smallest_square;
      for (int axis = 0; axis < 3; ++axis) {
        const double d = x(q, axis) - x(p, axis);
        along += d * (v(q, axis) - v(p, axis));
        squared += d * d;
      }
      power += row.dashpot[lane] * along * along / squared;
    }
  return power;
}

int Springs::count() const {
  double count = 0;
  for (const Row& row : rows_) count += row.multiplicity.sum();
  return int(count);
}

}  // namespace softffd
