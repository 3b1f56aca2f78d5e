#include "matrix/dissection.hpp"

#include <algorithm>
#include <limits>

namespace softffd {

namespace {

/// A box of at most this many points becomes one front. Smaller fronts would save fewer multiplications than their calls cost.
constexpr int smallest = 24;
/// Spacing of the planes along which a solid is cut: they are the planes between its patches.
constexpr int patch = 3;

}  // namespace

Dissection::Dissection(const Lattice& lattice) : lattice_(lattice), place_(lattice.points()) {
  const auto& n = lattice.counts;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) place_[lattice.index(i, j, k)].at = {i, j, k};
  dissect({{0, 0, 0}, {n[0] - 1, n[1] - 1, n[2] - 1}});
  order_boundaries();
}

/// Finds the plane nearest to the middle of the longest axis that has a plane inside the box; of equally long axes the last one counts.
/// Returns false if the box is not to be cut.
bool Dissection::find_cut(const Box& box, int& axis, int& plane) const {
  if (!lattice_.lobatto && box.points() <= smallest) return false;
  int longest = 0;
  for (int a = 0; a < 3; ++a) {
    const int middle = (box.first[a] + box.last[a]) / 2, spacing = lattice_.lobatto ? patch : 1;
    const int nearest = (middle + spacing / 2) / spacing * spacing;
    if (nearest <= box.first[a] || nearest >= box.last[a] || box.extent(a) < longest) continue;
    axis = a, plane = nearest, longest = box.extent(a);
  }
  return longest > 0;
}

void Dissection::dissect(const Box& box) {
  int axis, plane;
  if (!find_cut(box, axis, plane)) return add_front(box, box);
  Box before = box, between = box, after = box;
  before.last[axis] = plane - 1;
  between.first[axis] = between.last[axis] = plane;
  after.first[axis] = plane + 1;
  dissect(before);
  dissect(after);
  add_front(between, box);
}

/// Adds the front of the points `own`, which are eliminated last in the box `around`. The boundary consists of the points next to that box.
void Dissection::add_front(const Box& own, const Box& around) {
  Front front{.own = own.points()};
  Box wide = around;
  for (int a = 0; a < 3; ++a) {
    wide.first[a] = std::max(wide.first[a] - 1, 0);
    wide.last[a] = std::min(wide.last[a] + 1, lattice_.counts[a] - 1);
    front.corner[a] = wide.first[a];
    front.extent[a] = wide.extent(a);
  }
  const auto within = [](const Box& box, const std::array<int, 3>& at) {
    for (int a = 0; a < 3; ++a)
      if (at[a] < box.first[a] || at[a] > box.last[a]) return false;
    return true;
  };
  std::vector<int> boundary;
  for (int k = wide.first[2]; k <= wide.last[2]; ++k)
    for (int j = wide.first[1]; j <= wide.last[1]; ++j)
      for (int i = wide.first[0]; i <= wide.last[0]; ++i) {
        const int p = lattice_.index(i, j, k);
        if (within(own, {i, j, k})) {
          place_[p].front = int(fronts_.size());
          place_[p].row = int(front.points.size());
          front.points.push_back(p);
        } else if (!within(around, {i, j, k})) {
          boundary.push_back(p);
        }
      }
  front.points.insert(front.points.end(), boundary.begin(), boundary.end());
  fronts_.push_back(std::move(front));
}

void Dissection::order_boundaries() {
  const auto earlier = [&](int p, int q) {
    return place_[p].front != place_[q].front ? place_[p].front < place_[q].front : place_[p].row < place_[q].row;
  };
  for (Front& front : fronts_) {
    std::sort(front.points.begin() + front.own, front.points.end(), earlier);
    if (front.boundary() > 0) front.parent = place_[front.points[front.own]].front;
    front.rows.assign(front.extent[0] * front.extent[1] * front.extent[2], std::numeric_limits<std::int16_t>::min());
    for (int row = 0; row < int(front.points.size()); ++row) front.rows[in_box(front, front.points[row])] = std::int16_t(row);
  }
  std::vector<bool> has_child(fronts_.size(), false);
  for (Front& front : fronts_) {
    if (front.parent < 0) continue;
    front.first_child = !has_child[front.parent];
    has_child[front.parent] = true;
    for (int i = 0; i < front.boundary(); ++i) {
      const int to = row(fronts_[front.parent], front.points[front.own + i]);
      if (front.in_parent.empty() || to != front.in_parent.back().to + front.in_parent.back().count || to == fronts_[front.parent].own)
        front.in_parent.push_back({i, to, 0});
      ++front.in_parent.back().count;
    }
  }
}

double Dissection::factor_work() const {
  double work = 0;
  for (const Front& front : fronts_) {
    const double own = 3.0 * front.own, rest = 3.0 * front.boundary();
    work += own * (own * own / 6 + 0.5 * own * rest + 0.5 * rest * rest);
  }
  return work;
}

double Dissection::solution_work() const {
  double work = 0;
  for (const Front& front : fronts_) work += 9.0 * front.own * (front.own + 2.0 * front.boundary());
  return work;
}

}  // namespace softffd
