#include "bernstein.hpp"
#include "check.hpp"

using namespace softffd;

TEST(weights_sum_to_one_for_every_degree) {
  for (int n = 2; n <= 32; ++n)
    for (double t : {0.0, 1e-9, 0.3, 0.5, 0.99, 1.0}) {
      CHECK_NEAR(bernstein(t, n).sum(), 1.0, 1e-14);
      CHECK((bernstein(t, n) >= 0).all());
    }
}

TEST(cubic_weights_are_the_published_ones) {
  const double t = 0.3, u = 0.7;
  const Scalars b = bernstein(t, 4);
  CHECK_NEAR(b[0], u * u * u, 1e-16);
  CHECK_NEAR(b[1], 3 * t * u * u, 1e-16);
  CHECK_NEAR(b[2], 3 * t * t * u, 1e-16);
  CHECK_NEAR(b[3], t * t * t, 1e-16);
}

TEST(a_rest_lattice_reproduces_every_point_of_its_box) {
  const Lattice lattice{{4, 3, 5}, {-1, 2, 0.5}, {2, 0.3, 7}};
  const Points rest = rest_positions(lattice);
  for (double s : {0.0, 0.2, 0.77, 1.0}) {
    const Vec3 at = lattice.origin + lattice.size.cwiseProduct(Vec3(s, 1 - s, 0.5 * s));
    const Scalars weights = embedding_weights(lattice, at);
    for (int axis = 0; axis < 3; ++axis) CHECK_NEAR((weights * rest.col(axis)).sum(), at[axis], 1e-14);
  }
}
