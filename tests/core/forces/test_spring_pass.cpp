#include "bodies.hpp"
#include "check.hpp"
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

const std::vector<std::array<int, 3>> several{{2, 2, 2},  {4, 4, 4},  {3, 5, 4},  {5, 5, 5}, {2, 3, 7},
                                              {16, 2, 2}, {2, 2, 16}, {32, 3, 2}, {9, 8, 7}, {32, 32, 3}};

}  // namespace

TEST(forces_are_the_springs_sums_to_the_last_bit) {
  for (const std::array<int, 3> counts : several) {
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
  for (const int side : {4, 7}) {
    const Lattice lattice{{side, side, side}};
    Springs springs(lattice, Topology::distinct);
    const Points x = crumpled(lattice);
    Points f(x.rows(), 3);
    springs.set_stiffness({1000, 700, 300}, {});
    springs.force(x, f);
    springs.set_stiffness({1000, 0, 0}, {});
    springs.force(x, f);
    CHECK((f == summed(listed(springs), x)).all());
  }
}

TEST(a_stage_is_forces_kicks_and_a_drift_to_the_last_bit) {
  for (const std::array<int, 3> counts : several) {
    const Lattice lattice{counts};
    Springs springs(lattice, Topology::distinct);
    springs.set_stiffness({1000, 700, 300}, {});
    const Points x = crumpled(lattice), outside = 3 * x.reverse();
    const auto share = [&](double least) -> Scalars { return least + 0.1 * x.col(0).sin(); };
    const Scalars a = share(0.8), b = share(0.01), c = share(0.7), d = share(0.02);
    Points f(x.rows(), 3), next(x.rows(), 3);
    springs.force(x, f);
    for (const int kicks : {1, 2}) {
      Points v = x.square(), w = v;
      springs.advance({{Stage::Kick{a.data(), b.data()}, Stage::Kick{c.data(), d.data()}}, kicks, 0.3}, outside, x, v, next);
      for (int axis = 0; axis < 3; ++axis) w.col(axis) = a * w.col(axis) + b * (f.col(axis) + outside.col(axis));
      for (int axis = 0; kicks > 1 && axis < 3; ++axis) w.col(axis) = c * w.col(axis) + d * (f.col(axis) + outside.col(axis));
      CHECK((v == w).all());
      CHECK((next == x + 0.3 * w).all());
    }
  }
}

TEST(of_some_blocks_a_stage_keeps_what_lies_between_its_kicks) {
  for (const std::array<int, 3> counts : several) {
    const Lattice lattice{counts};
    Springs springs(lattice, Topology::distinct);
    springs.set_stiffness({1000, 700, 300}, {});
    const Points x = crumpled(lattice), outside = 3 * x.reverse(), start = x.square();
    const int points = int(x.rows());
    const Scalars a = 0.8 + 0.1 * x.col(0).sin(), b = 0.01 * a;
    const Stage::Kick kick{a.data(), b.data()};
    Points spring(points, 3), w = start, v(points, 3), next(points, 3), unused(points, 3);
    springs.force(x, spring);
    springs.advance({{kick, kick}, 2, 0.3}, outside, x, w, unused);
    std::vector<Count> until((points + SpringPass::lanes - 1) / SpringPass::lanes);
    for (std::size_t i = 0; i < until.size(); i += 2) until[i] = 1;
    Points before = start, f = Points::Constant(points, 3, -1);
    springs.advance({{kick, kick}, 2, 0.3}, outside, x, before, v, next, {until.data(), 1, f.data()});
    CHECK((v == w).all() && (next == x + 0.3 * w).all());
    for (int p = 0; p < points; ++p)
      for (int axis = 0; axis < 3; ++axis) {
        const bool kept = p / SpringPass::lanes % 2 == 0;
        CHECK(f(p, axis) == (kept ? spring(p, axis) : -1));
        CHECK(before(p, axis) == (kept ? a[p] * start(p, axis) + b[p] * (spring(p, axis) + outside(p, axis)) : start(p, axis)));
      }
  }
}

TEST(a_team_gives_the_bits_of_one_thread) {
  for (const std::array<int, 3> counts : several) {
    const Lattice lattice{counts};
    std::vector<bool> some(lattice.points(), false);
    for (int p = 0; p < lattice.points(); p += 3) some[p] = true;
    const Points x = crumpled(lattice), outside = 3 * x.reverse();
    const Scalars a = 0.8 + 0.1 * x.col(0).sin(), b = 0.01 * a;
    const Stage stage{{Stage::Kick{a.data(), b.data()}, Stage::Kick{a.data(), b.data()}}, 2, 0.3};
    Points f(x.rows(), 3), v(x.rows(), 3), next(x.rows(), 3);
    for (const int members : {1, 2, 3, 5}) {
      Springs springs(lattice, Topology::paper, members > 1 ? std::make_shared<Team>(members) : nullptr);
      springs.set_stiffness({1000, 700, 300}, {{some, 41}});
      for (int again = 0; again < 3; ++again) {
        Points g = Points::Constant(x.rows(), 3, -1), w = x.square(), after = g;
        springs.force(x, g);
        springs.advance(stage, outside, x, w, after);
        if (members == 1) f = g, v = w, next = after;
        CHECK((g == f).all() && (w == v).all() && (after == next).all());
      }
    }
  }
}

TEST(parts_are_the_whole_lattice_and_none_is_empty) {
  for (const std::array<int, 3> counts : several)
    for (const int members : {2, 3, 5, 64}) {
      const Lattice lattice{counts};
      const SpringPass pass(lattice, std::make_shared<Team>(members));
      int end = 0;
      for (const SpringPass::Part& part : pass.parts) {
        CHECK(part.begin == end && part.end > part.begin && part.lead <= part.begin);
        end = part.end;
      }
      CHECK(end == (lattice.points() + SpringPass::lanes - 1) / SpringPass::lanes);
      CHECK(int(pass.parts.size()) == std::min(members, end));
    }
}

TEST(threads_that_lattices_have_work_for) {
  CHECK(SpringPass::threads_of_use(Lattice{{4, 4, 4}}, 2) == 1);
  CHECK(SpringPass::threads_of_use(Lattice{{16, 16, 16}}, 1) == 1);
  CHECK(SpringPass::threads_of_use(Lattice{{16, 16, 16}}, 2) == 2);
  CHECK(SpringPass::threads_of_use(Lattice{{16, 16, 16}}, 64) == 8);
  CHECK(SpringPass::threads_of_use(Lattice{{32, 32, 32}}, 64) == 64);
}

TEST(like_blocks_share_their_springs) {
  SpringPass pass(Lattice{{32, 32, 32}}, nullptr);
  Springs springs(Lattice{{32, 32, 32}}, Topology::distinct);
  springs.set_stiffness({1000, 700, 300}, {});
  SpringPass::Rows rows;
  for (std::size_t d = 0; d < rows.size(); ++d) rows[d] = springs.rows()[d].view();
  pass.set(rows);
  CHECK(pass.kinds.different() < 400);  // of 4096
}
