#include "contact/coulomb_rows.hpp"

#include "check.hpp"
#include "model/plane.hpp"
#include "random_numbers.hpp"

using namespace softffd;

namespace {

using Mat3 = Eigen::Matrix3d;

Operations operations;

/// How far a force at one arm moves another: of a rigid body; or as masses do that have no direction.
template <class Block>
Block moved(const Vec3& a, const Vec3& b, double soft) {
  const double own = &a == &b ? soft : 0;
  if constexpr (std::is_same_v<Block, Mat3>)
    return 1e-4 * (Mat3::Identity() + 4 * (a.dot(b) * Mat3::Identity() - b * a.transpose())) + own * Mat3::Identity();
  else
    return 1e-4 * (1 + 4 * a.dot(b)) + own;
}

/// Rows pressed onto planes that lean this much, and pushed along them.
template <class Block>
typename CoulombRows<Block>::Problem problem(Random& random, int rows, double soft, double friction, double leaning = 0.2) {
  typename CoulombRows<Block>::Problem made;
  std::vector<Vec3> arms;
  for (int s = 0; s < rows; ++s) {
    made.normals.push_back((Vec3::UnitZ() + random.vector(leaning)).normalized());
    made.friction.push_back(friction);
    arms.push_back(random.vector(0.5));
    made.u.push_back(Vec3(0, 0, -0.05) + random.vector(0.04));
  }
  for (const Vec3& a : arms)
    for (const Vec3& b : arms) made.g.push_back(moved<Block>(a, b, soft));
  made.exact = 1e-15;
  return made;
}

template <class Block>
std::vector<Vec3> displacements(const typename CoulombRows<Block>::Problem& made, const std::vector<Vec3>& force) {
  std::vector<Vec3> u = made.u;
  for (std::size_t s = 0; s < u.size(); ++s)
    for (std::size_t t = 0; t < u.size(); ++t) u[s] += made.g[s * u.size() + t] * force[t];
  return u;
}

/// Returns whether a solution was found, which is checked.
template <class Block>
bool keeps_the_law(const typename CoulombRows<Block>::Problem& made) {
  const int rows = int(made.u.size());
  std::vector<Vec3> force(rows, Vec3::Zero());
  CoulombRows<Block> solver;
  if (solver.solve(made, operations, force) > 1e-13) return false;
  const std::vector<Vec3> u = displacements<Block>(made, force);
  for (int s = 0; s < rows; ++s) {
    const Vec3 &normal = made.normals[s], across = tangential(normal, force[s]), slip = tangential(normal, u[s]);
    const double load = normal.dot(force[s]), gap = normal.dot(u[s]), limit = made.friction[s] * load;
    const double own = (Mat3::Identity() * made.g[s * rows + s]).trace() / 3;
    CHECK(load >= -1e-12 / own && gap >= -1e-12);
    CHECK(std::min(load * own, gap) <= 1e-12);
    CHECK(across.norm() <= limit + 1e-12 / own);
    if (across.norm() < limit - 1e-9 / own) CHECK(slip.norm() <= 1e-12);
    if (slip.norm() > 1e-9) CHECK((across + limit * slip.normalized()).norm() <= 1e-9 / own);
  }
  return true;
}

}  // namespace

TEST(forces_keep_to_coulombs_law) {
  Random random, of_masses;
  int found = 0, tries = 0;
  for (const double soft : {1e-5, 1e-7, 1e-9})
    for (const double friction : {0.0, 0.3, 1.0})
      for (int n = 0; n < 40; ++n) {
        tries += 3;
        found += keeps_the_law<Mat3>(problem<Mat3>(random, 1 + n % 8, soft, friction));
        for (const double leaning : {0.0, 0.8})
          found += keeps_the_law<double>(problem<double>(of_masses, 1 + n % 12, soft, friction, leaning));
      }
  CHECK(found >= tries - tries / 50);  // what is not found is told, and not taken
}

TEST(where_rows_aim_to_begin_with_is_no_matter_to_the_solution) {
  Random random;
  for (int n = 0; n < 20; ++n) {
    auto made = problem<double>(random, 1 + n % 8, 1e-5, 0.4);
    std::vector<Vec3> force(made.u.size(), Vec3::Zero()), other = force;
    CoulombRows<double> solver;
    CHECK(solver.solve(made, operations, force) <= 1e-15);
    for (const Vec3& normal : made.normals) made.aims.push_back(normal + random.vector(0.6));
    CHECK(solver.solve(made, operations, other) <= 1e-15);
    for (std::size_t s = 0; s < force.size(); ++s) CHECK((force[s] - other[s]).norm() <= 1e-8 * force[s].norm() + 1e-9);
  }
}

TEST(what_is_the_solution_already_stays_so) {
  Random random;
  const auto made = problem<Mat3>(random, 5, 1e-6, 0.4);
  std::vector<Vec3> force(5, Vec3::Zero());
  CoulombRows<Mat3> solver;
  CHECK(solver.solve(made, operations, force) <= 1e-13);
  auto again = made;
  again.u = displacements<Mat3>(made, force);
  again.exact = 1e-13;
  const std::vector<Vec3> before = force;
  const Count taken = solver.iterations();
  solver.solve(again, operations, force);
  CHECK(solver.iterations() == taken);
  for (int s = 0; s < 5; ++s) CHECK(force[s] == before[s]);
}
