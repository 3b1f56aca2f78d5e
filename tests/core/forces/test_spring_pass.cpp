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

Springs springs_of(const Lattice& lattice, Topology topology = Topology::distinct, int every = 0, std::shared_ptr<Team> team = {}) {
  Springs springs(lattice, topology, team);
  std::vector<bool> some(lattice.points(), false);
  for (int p = 0; every && p < lattice.points(); p += every) some[p] = true;
  springs.set_stiffness({1000, 700, 300}, {{some, 41}});
  return springs;
}

/// A crumpled lattice, outside forces on it, and kicks of it.
struct Kicked {
  Lattice lattice;
  int points = lattice.points();
  Points x = crumpled(lattice), outside = 3 * x.reverse(), v0 = x.square(), none = Points::Constant(points, 3, -1);
  Scalars a = 0.8 + 0.1 * x.col(0).sin(), b = 0.01 + 0.1 * x.col(0).sin(), c = a - 0.1, d = b + 0.01;
  Stage::Kick first{a.data(), b.data()}, second{c.data(), d.data()};
  explicit Kicked(const std::array<int, 3>& counts) : lattice{counts} {}
  Kicked(const Kicked&) = delete;

  Points forces(const Springs& springs) const {
    Points f(points, 3);
    springs.set_force(x, f);
    return f;
  }
  Points kicked(const Points& v, const Points& f, const Scalars& keep, const Scalars& gain) const {
    Points w = v;
    for (int axis = 0; axis < 3; ++axis) w.col(axis) = keep * w.col(axis) + gain * (f.col(axis) + outside.col(axis));
    return w;
  }
};

}  // namespace

TEST(forces_are_the_springs_sums_to_the_last_bit_and_what_was_no_number_once_is_forgotten) {
  for (const std::array<int, 3> counts : several) {
    const Kicked k(counts);
    const Springs springs = springs_of(k.lattice, Topology::paper, 2);
    CHECK((k.forces(springs) == summed(listed(springs), k.x)).all());
    Points f(k.points, 3);
    springs.set_force(Points::Constant(k.points, 3, std::nan("")), f);
    CHECK(f.isNaN().any() && (k.forces(springs) == summed(listed(springs), k.x)).all());
  }
}

TEST(directions_without_springs_cost_no_forces) {
  for (const int side : {4, 7}) {
    const Kicked k({side, side, side});
    Springs springs = springs_of(k.lattice);
    k.forces(springs);
    springs.set_stiffness({1000, 0, 0}, {});
    CHECK((k.forces(springs) == summed(listed(springs), k.x)).all());
  }
}

TEST(a_stage_is_forces_kicks_and_a_drift_to_the_last_bit_and_of_some_blocks_it_keeps_what_lies_between) {
  for (const std::array<int, 3> counts : several) {
    const Kicked k(counts);
    const Springs springs = springs_of(k.lattice);
    const Points f = k.forces(springs);
    const Points once = k.kicked(k.v0, f, k.a, k.b), w = k.kicked(once, f, k.c, k.d);
    Points next(k.points, 3);
    for (const int kicks : {1, 2}) {
      Points v = k.v0;
      const Points& wanted = kicks > 1 ? w : once;
      springs.advance({{k.first, k.second}, kicks, 0.3}, k.outside, k.x, v, next);
      CHECK((v == wanted).all() && (next == k.x + 0.3 * wanted).all());
    }
    std::vector<Count> until((k.points + SpringPass::lanes - 1) / SpringPass::lanes);
    for (std::size_t i = 0; i < until.size(); i += 2) until[i] = 1;
    Points before = k.v0, between = k.none, v(k.points, 3);
    springs.advance({{k.first, k.second}, 2, 0.3}, k.outside, k.x, before, v, next, {until.data(), 1, between.data()});
    CHECK((v == w).all() && (next == k.x + 0.3 * w).all());
    for (int p = 0; p < k.points; ++p) {
      const bool kept = p / SpringPass::lanes % 2 == 0;
      CHECK((between.row(p) == (kept ? f : k.none).row(p)).all() && (before.row(p) == (kept ? once : k.v0).row(p)).all());
    }
  }
}

TEST(a_team_gives_the_bits_of_one_thread) {
  for (const std::array<int, 3> counts : several) {
    const Kicked k(counts);
    Points f, v, next;
    for (const int members : {1, 2, 3, 5}) {
      const Springs springs = springs_of(k.lattice, Topology::paper, 3, members > 1 ? std::make_shared<Team>(members) : nullptr);
      for (int again = 0; again < 3; ++again) {
        Points g = k.none, w = k.v0, after = k.none;
        springs.set_force(k.x, g);
        springs.advance({{k.first, k.second}, 2, 0.3}, k.outside, k.x, w, after);
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
  const Springs springs = springs_of(Lattice{{32, 32, 32}});
  SpringPass::Rows rows;
  for (std::size_t d = 0; d < rows.size(); ++d) rows[d] = springs.rows()[d].view();
  pass.set(rows);
  CHECK(pass.kinds.different() < 400);  // of 4096
}
