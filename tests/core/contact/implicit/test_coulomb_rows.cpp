#include "contact/implicit/coulomb_rows.hpp"

#include "check.hpp"
#include "model/plane.hpp"
#include "random_numbers.hpp"

using namespace softffd;

namespace {

/// Rows that a body's rigid motions and its own compliance couple, pressed onto planes and pushed along them.
CoulombRows::Problem problem(Random& random, int rows, double soft, double friction) {
  CoulombRows::Problem made;
  std::vector<Vec3> arms;
  for (int s = 0; s < rows; ++s) {
    made.normals.push_back((Vec3::UnitZ() + random.vector(0.2)).normalized());
    made.friction.push_back(friction);
    arms.push_back(random.vector(0.5));
    made.u.push_back(Vec3(0, 0, -0.05) + random.vector(0.04));
  }
  for (const Vec3& a : arms)
    for (const Vec3& b : arms) {
      const Eigen::Matrix3d turn = a.dot(b) * Eigen::Matrix3d::Identity() - b * a.transpose();
      const Eigen::Matrix3d own = &a == &b ? Eigen::Matrix3d(soft * Eigen::Matrix3d::Identity()) : Eigen::Matrix3d(Eigen::Matrix3d::Zero());
      made.g.push_back(1e-4 * (Eigen::Matrix3d::Identity() + 4 * turn) + own);
    }
  made.exact = 1e-15;
  return made;
}

}  // namespace

TEST(forces_keep_to_coulombs_law) {
  Random random;
  int found = 0, tries = 0;
  for (const double soft : {1e-5, 1e-7, 1e-9})
    for (const double friction : {0.0, 0.3, 1.0})
      for (int n = 0; n < 40; ++n) {
        const int rows = 1 + n % 8;
        const CoulombRows::Problem made = problem(random, rows, soft, friction);
        std::vector<Vec3> force(rows, Vec3::Zero());
        CoulombRows solver;
        ++tries;
        if (solver.solve(made, force) > 1e-13) continue;  // told, and not taken
        ++found;
        for (int s = 0; s < rows; ++s) {
          Vec3 u = made.u[s];
          for (int t = 0; t < rows; ++t) u += made.g[s * rows + t] * force[t];
          const Vec3 &normal = made.normals[s], across = tangential(normal, force[s]), slip = tangential(normal, u);
          const double load = normal.dot(force[s]), gap = normal.dot(u), limit = friction * load, own = made.g[s * rows + s].trace() / 3;
          CHECK(load >= -1e-12 / own && gap >= -1e-12);
          CHECK(std::min(load * own, gap) <= 1e-12);
          CHECK(across.norm() <= limit + 1e-12 / own);
          if (across.norm() < limit - 1e-9 / own) CHECK(slip.norm() <= 1e-12);
          if (slip.norm() > 1e-9) CHECK((across + limit * slip.normalized()).norm() <= 1e-9 / own);
        }
      }
  CHECK(found >= tries - tries / 50);
}

TEST(what_is_the_solution_already_stays_so) {
  Random random;
  const CoulombRows::Problem made = problem(random, 5, 1e-6, 0.4);
  std::vector<Vec3> force(5, Vec3::Zero());
  CoulombRows solver;
  CHECK(solver.solve(made, force) <= 1e-13);
  CoulombRows::Problem again = made;
  for (int s = 0; s < 5; ++s)
    for (int t = 0; t < 5; ++t) again.u[s] += made.g[s * 5 + t] * force[t];
  again.exact = 1e-13;
  const std::vector<Vec3> before = force;
  const Count taken = solver.iterations();
  solver.solve(again, force);
  CHECK(solver.iterations() == taken);
  for (int s = 0; s < 5; ++s) CHECK(force[s] == before[s]);
}
