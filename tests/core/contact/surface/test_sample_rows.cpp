#include "contact/surface/sample_rows.hpp"

#include "check.hpp"
#include "random_numbers.hpp"

using namespace softffd;

TEST(many_rows_at_once_are_each_sample_by_itself) {
  Random random;
  const std::array<int, 3> lattices[] = {{4, 4, 4}, {2, 2, 2}, {3, 5, 3}, {8, 8, 8}};
  for (const auto& counts : lattices)
    for (const Basis basis : {Basis::bezier, Basis::bspline})
      for (int count = 1; count <= 9; ++count) {
        const Lattice lattice{.counts = counts};
        std::vector<Vec3> places;
        for (int s = 0; s < count; ++s) places.push_back({random(0, 1), random(0, 1), s % 3 ? random(0, 1) : 0.0});
        const Samples samples(basis, lattice, places);
        std::vector<SurfaceRow> rows;
        for (int s = 0; s < count; ++s) rows.push_back({0, s});
        SampleRows together(samples);
        together.set(rows);
        Points x(lattice.points(), 3);
        for (Eigen::Index i = 0; i < x.size(); ++i) x(i) = random(-1, 1);
        std::vector<Vec3> at;
        std::vector<double> gaps;
        together.at(x, at);
        together.at(Scalars(x.col(2)), gaps);
        for (int s = 0; s < count; ++s) {
          const Vec3 wanted = samples.at(s, x);
          CHECK((at[s] - wanted).norm() < 1e-14);
          CHECK_NEAR(gaps[s], wanted.z(), 1e-14);
        }
      }
}

TEST(where_all_samples_lie_on_a_face_the_points_of_that_face_count) {
  const Samples samples(Basis::bezier, {}, {{0.2, 0.3, 0}, {0.7, 0.5, 0}, {0.5, 0.5, 1}});
  const auto range = [&](const std::vector<int>& of) {
    std::vector<double> weights(64 * of.size());
    for (std::size_t t = 0; t < of.size(); ++t) samples.weights(of[t], Scalars::Ones(64), &weights[64 * t]);
    return Samples::range(weights.data(), int(of.size()), 64);
  };
  CHECK((range({0, 1}) == PointRange{0, 16}));
  CHECK((range({2}) == PointRange{48, 64}));
  CHECK((range({1, 2}) == PointRange{0, 64}));
}
