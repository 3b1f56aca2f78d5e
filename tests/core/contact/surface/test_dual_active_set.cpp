#include "contact/surface/dual_active_set.hpp"

#include <algorithm>

#include "check.hpp"
#include "random_numbers.hpp"

using namespace softffd;

namespace {

/// A crushed lattice with samples all over it, planes, and gaps of the samples that want mending.
struct Problem {
  Lattice lattice;
  Samples samples;
  Scalars inverse_mass;
  std::vector<Vec3> normals;
  std::vector<GapFunction> gaps;
  std::vector<Candidate> candidates;
};

std::vector<Vec3> places(Random& random, int count, bool crowded) {
  std::vector<Vec3> list;
  for (int s = 0; s < count; ++s) {
    Vec3 place(random(0, 1), random(0, 1), random(0, 1));
    if (crowded && s > 2) place = 0.97 * list[s % 3] + 0.03 * place;
    list.push_back(s % 7 == 6 ? list[s - 1] : place);  // the same place twice
  }
  return list;
}

Problem random_problem(Random& random, int count, int planes, bool crowded, Basis basis = Basis::bezier, int n = 4) {
  Lattice lattice{.counts = {n, n, n}};
  Problem problem{lattice, Samples(basis, lattice, places(random, count, crowded)), Scalars::Zero(lattice.points()), {}, {}, {}};
  for (double& m : problem.inverse_mass) m = 1 / random(0.05, 20);
  const Points x = rest_positions(lattice);
  for (int q = 0; q < planes; ++q) {
    problem.normals.push_back(Vec3(random(-0.4, 0.4), random(-0.4, 0.4) + (q == 1), 1 - (q == 2)).normalized());
    Scalars h(lattice.points());
    for (int p = 0; p < lattice.points(); ++p) h[p] = problem.normals[q].dot(row(x, p)) - 0.4 + random(-0.4, 0.4);
    problem.gaps.push_back({h});
    for (int s = 0; s < count; ++s) problem.candidates.push_back({{q, s}, random(-0.05, 0.05)});
  }
  return problem;
}

DualActiveSet solver_of(const Problem& problem) {
  DualActiveSet solver(problem.samples);
  solver.delassus().set_normals(problem.normals);
  solver.delassus().set_masses(problem.inverse_mass);
  return solver;
}

/// Everything that makes the gaps the one solution of the convex problem: no row violated, forces that push, at rows that are met.
void check_optimal(const Problem& problem, const DualActiveSet& solver, const std::vector<GapFunction>& gaps) {
  for (const Candidate& c : problem.candidates) CHECK(gaps[c.row.plane].at(problem.samples, c.row.sample) - c.bound >= -4e-15);
  for (std::size_t t = 0; t < solver.active().size(); ++t) {
    const SurfaceRow row = solver.active()[t];
    const auto c = std::find_if(problem.candidates.begin(), problem.candidates.end(), [&](const Candidate& c) { return c.row == row; });
    CHECK(solver.forces()[t] >= 0);
    CHECK_NEAR(gaps[row.plane].at(problem.samples, row.sample), c->bound, 4e-15);
  }
  CHECK(std::is_sorted(solver.active().begin(), solver.active().end()));
  for (int q = 0; q < int(problem.normals.size()); ++q) {  // gaps are those of the forces
    Scalars h = problem.gaps[q].of_points;
    for (std::size_t t = 0; t < solver.active().size(); ++t) {
      const double f = solver.forces()[t] * problem.normals[q].dot(problem.normals[solver.active()[t].plane]);
      const Embedding at = embed(Basis::bezier, problem.lattice, problem.samples.place(solver.active()[t].sample));
      for (std::size_t i = 0; i < at.points.size(); ++i) h[at.points[i]] += f * at.weights[i] * problem.inverse_mass[at.points[i]];
    }
    CHECK((h - gaps[q].of_points).abs().maxCoeff() < 1e-12 * (1 + h.abs().maxCoeff()));
  }
}

}  // namespace

TEST(random_crowded_problems_are_solved_exactly_also_where_rows_that_depend_on_each_other_are_the_start) {
  Random random;
  for (int i = 0; i < 600; ++i) {
    const bool started = i >= 400;
    Problem problem = started ? random_problem(random, 80, 1, i % 2 == 1) : random_problem(random, 4 + i % 60, 1 + i % 3, i % 2 == 1);
    DualActiveSet solver = solver_of(problem);
    std::vector<SurfaceRow> all;  // more than points have gaps: no start, and nothing changes
    for (const Candidate& candidate : problem.candidates) all.push_back(candidate.row);
    if (started) solver.delassus().set_rows(all);
    std::vector<GapFunction> gaps = problem.gaps;
    CHECK(solver.solve(problem.candidates, gaps, 1e-15) == StepStatus::ok);
    check_optimal(problem, solver, gaps);
  }
}

TEST(rows_that_were_active_before_lead_to_the_same_solution) {
  Random random;
  for (int i = 0; i < 40; ++i) {
    Problem problem = random_problem(random, 40, 1 + i % 2, false);
    DualActiveSet cold = solver_of(problem), warm = cold;
    std::vector<GapFunction> a = problem.gaps, b = a;
    cold.solve(problem.candidates, a, 1e-15);
    std::vector<SurfaceRow> before;
    for (std::size_t c = 0; c < problem.candidates.size(); c += 9) before.push_back(problem.candidates[c].row);
    warm.delassus().set_rows(before);
    CHECK(warm.solve(problem.candidates, b, 1e-15) == StepStatus::ok);
    for (std::size_t q = 0; q < a.size(); ++q) CHECK((a[q].of_points - b[q].of_points).abs().maxCoeff() < 1e-12);
    std::vector<GapFunction> c = problem.gaps;
    warm.delassus().set_rows(cold.active());
    warm.solve(problem.candidates, c, 1e-15);
    for (std::size_t q = 0; q < a.size(); ++q) CHECK((a[q].of_points == c[q].of_points).all());
  }
}

TEST(planes_of_one_sample_each_lead_to_the_solution_of_planes_of_all) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    Problem problem = random_problem(random, 4 + i % 30, 1 + i % 3, false);
    std::vector<Vec3> normals;  // a plane for each row
    std::vector<GapFunction> each;
    std::vector<Candidate> candidates;
    for (const Candidate& candidate : problem.candidates) {
      const auto [plane, sample] = candidate.row;
      candidates.push_back({{int(normals.size()), sample}, candidate.bound});
      normals.push_back(problem.normals[plane]);
      each.push_back({{}, sample, problem.gaps[plane].at(problem.samples, sample)});
    }
    DualActiveSet of_all = solver_of(problem), of_each = solver_of(problem);
    of_each.delassus().set_normals(normals);
    CHECK(of_all.solve(problem.candidates, problem.gaps, 1e-15) == StepStatus::ok);
    CHECK(of_each.solve(candidates, each, 1e-15) == StepStatus::ok);
    for (std::size_t c = 0; c < candidates.size(); ++c) CHECK_NEAR(candidates[c].gap, problem.candidates[c].gap, 1e-12);
  }
}

TEST(plates_without_room_between_are_found_out_and_a_sample_of_pinned_points_is_reported_and_not_moved) {
  const Samples middle(Basis::bezier, {}, {{0.5, 0.5, 0.5}});
  Problem plates{{}, middle, Scalars::Ones(64), {{0, 0, 1}, {0, 0, -1}}, {}, {{{0, 0}}, {{1, 0}}}};
  plates.gaps = {{Scalars::Constant(64, -0.1)}, {Scalars::Constant(64, 0.05)}};
  CHECK(solver_of(plates).solve(plates.candidates, plates.gaps, 1e-15) == StepStatus::impossible_planes);
  Problem pinned{{}, middle, Scalars::Zero(64), {{0, 0, 1}}, {{Scalars::Constant(64, -0.1)}}, {{{0, 0}}}};
  DualActiveSet solver = solver_of(pinned);
  CHECK(solver.solve(pinned.candidates, pinned.gaps, 1e-15) == StepStatus::ok);
  CHECK_NEAR(solver.pinned_violation(), 0.1, 1e-15);
  CHECK(solver.active().empty());
}

TEST(samples_of_splines_meet_where_their_points_overlap) {
  Random random;
  const Lattice lattice{.counts = {8, 6, 9}};
  const Samples samples(Basis::bspline, lattice, places(random, 30, false));
  Scalars inverse(lattice.points());
  for (double& m : inverse) m = random(0.1, 3);
  std::vector<double> of_s(samples.support());
  for (int s = 0; s < 30; ++s)
    for (int t = 0; t < 30; ++t) {
      samples.weights(s, inverse, of_s.data());
      Scalars spread = Scalars::Zero(lattice.points());
      samples.add(s, 1, of_s.data(), spread.data());
      const Embedding at = embed(Basis::bspline, lattice, samples.place(t));
      CHECK_NEAR(samples.product(t, s, of_s.data()), at(spread), 1e-14);
      CHECK_NEAR(samples.at(t, spread.data()), at(spread), 1e-14);
    }
}
