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

TEST(cubic_weights_are_the_published_ones) {
  const double t = 0.3, u = 0.7;
  for (Basis basis : bases) {
    const Scalars b = weights(basis, t, 4);
    CHECK_NEAR(b[0], u * u * u, 1e-16);
    CHECK_NEAR(b[1], 3 * t * u * u, 1e-16);
    CHECK_NEAR(b[2], 3 * t * t * u, 1e-16);
    CHECK_NEAR(b[3], t * t * t, 1e-16);
  }
}

TEST(bsplines_between_far_ends_are_the_uniform_ones) {
  const Scalars at_a_point = weights(Basis::bspline, 0.5, 9), between = weights(Basis::bspline, 0.5, 10);
  const std::array<double, 3> thirds{1. / 6, 4. / 6, 1. / 6};
  const std::array<double, 4> halves{1. / 48, 23. / 48, 23. / 48, 1. / 48};
  for (int i = 0; i < 3; ++i) CHECK_NEAR(at_a_point[3 + i], thirds[i], 1e-15);
  for (int i = 0; i < 4; ++i) CHECK_NEAR(between[3 + i], halves[i], 1e-15);
}

TEST(an_embedding_holds_the_points_that_count) {
  const Lattice lattice{{32, 32, 32}, Vec3::Zero(), Vec3::Ones()};
  CHECK(embed(Basis::bspline, lattice, {0.31, 0.52, 0.93}).points.size() == 64);
  CHECK(embed(Basis::bezier, lattice, {0.31, 0.52, 0.93}).points.size() == 32 * 32 * 32);
}

TEST(a_rest_lattice_reproduces_every_point_of_its_box) {
  const Lattice lattice{{4, 3, 9}, {-1, 2, 0.5}, {2, 0.3, 7}};
  const Points rest = rest_positions(lattice);
  for (Basis basis : bases)
    for (double s : {0.0, 0.2, 0.77, 1.0}) {
      const Vec3 at = lattice.origin + lattice.size.cwiseProduct(Vec3(s, 1 - s, 0.5 * s));
      const Embedding point = embed(basis, lattice, at);
      for (int axis = 0; axis < 3; ++axis) CHECK_NEAR(point(rest.col(axis)), at[axis], 1e-14);
    }
}
