#include "check.hpp"
#include "crumpled.hpp"
#include "forces/springs.hpp"

using namespace softffd;

namespace {

struct Spring {
  int first, second;
  double stiffness, rest_length;
};

/// All springs of the lattice, direction by direction.
std::vector<std::vector<Spring>> listed(const Springs& springs) {
  std::vector<std::vector<Spring>> list;
  for (const Springs::Row& row : springs.rows()) {
    list.emplace_back();
    for (int n = 0; n < row.lanes(); ++n)
      if (row.stiffness[n] > 0) list.back().push_back({row.begin + n, row.begin + n + row.offset, row.stiffness[n], row.rest_length[n]});
  }
  return list;
}

/// The same forces, spring by spring: direction by direction, first ends before second ends.
Points summed(const std::vector<std::vector<Spring>>& list, const Points& x) {
  Points f = Points::Zero(x.rows(), 3);
  for (const auto& direction : list)
    for (const bool first : {true, false})
      for (const Spring& s : direction) {
        const Vec3 d = row(x, s.second) - row(x, s.first);
        const double r = std::sqrt(d.x() * d.x() + d.y() * d.y() + d.z() * d.z() + kernels::smallest_square);
        const double pull = s.stiffness * (1.0 - s.rest_length / r);
        for (int a = 0; a < 3; ++a) f(first ? s.first : s.second, a) += (first ? pull : -pull) * d[a];
      }
  return f;
}

}  // namespace

TEST(forces_are_the_springs_sums_to_the_last_bit) {
  for (const std::array<int, 3> counts : std::vector<std::array<int, 3>>{
           {2, 2, 2}, {4, 4, 4}, {3, 5, 4}, {5, 5, 5}, {2, 3, 7}, {16, 2, 2}, {2, 2, 16}, {32, 3, 2}, {9, 8, 7}, {32, 32, 3}}) {
    const Lattice lattice{counts};
    Springs springs(lattice, Topology::paper);
    std::vector<bool> some(lattice.points(), false);
    for (int p = 0; p < lattice.points(); p += 2) some[p] = true;
    springs.set_stiffness({1000, 700, 300}, {{some, 41}});
    const Points x = crumpled(lattice);
    Points f(x.rows(), 3);
    springs.force(x, f);
    CHECK((f == summed(listed(springs), x)).all());
  }
}

TEST(what_was_no_number_once_is_forgotten) {
  const Lattice lattice{{5, 4, 6}};
  Springs springs(lattice, Topology::distinct);
  springs.set_stiffness({1000, 700, 300}, {});
  const Points x = crumpled(lattice);
  Points broken = x, before(x.rows(), 3), after(x.rows(), 3);
  springs.force(x, before);
  broken.setConstant(std::nan(""));
  springs.force(broken, after);
  CHECK(after.isNaN().any());
  springs.force(x, after);
  CHECK((before == after).all());
}

TEST(directions_without_springs_cost_no_forces) {
  const Lattice lattice;
  Springs springs(lattice, Topology::distinct);
  springs.set_stiffness({1000, 700, 300}, {});
  springs.set_stiffness({1000, 0, 0}, {});
  const Points x = crumpled(lattice);
  Points f(x.rows(), 3);
  springs.force(x, f);
  CHECK((f == summed(listed(springs), x)).all());
}
