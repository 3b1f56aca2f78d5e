#include "model/basis.hpp"

#include "check.hpp"

using namespace softffd;

constexpr std::array bases{Basis::bezier, Basis::bspline};
constexpr std::array places{0.0, 1e-9, 0.01, 0.3, 0.5, 0.77, 0.99, 1.0};

TEST(weights_sum_to_one_are_not_negative_and_reproduce_the_place_for_every_number_of_points) {
  for (Basis basis : bases)
    for (int n = 2; n <= 32; ++n)
      for (double t : places) {
        const Scalars w = weights(basis, t, n);
        CHECK_NEAR(w.sum(), 1.0, 1e-14);
        CHECK((w >= 0).all() && (basis == Basis::bezier || n < 5 || (w > 0).count() <= 4));  // at most four B-splines an axis count
        CHECK_NEAR((w * Scalars::LinSpaced(n, 0, 1)).sum(), t, 1e-14);
      }
}

TEST(an_embedding_holds_the_points_that_count) {
  const Lattice lattice{{32, 32, 32}, Vec3::Zero(), Vec3::Ones()};
  CHECK(embed(Basis::bspline, lattice, {0.31, 0.52, 0.93}).points.size() == 64);
  CHECK(embed(Basis::bezier, lattice, {0.31, 0.52, 0.93}).points.size() == 32 * 32 * 32);
}
