#include "model/lobatto.hpp"

#include "bodies.hpp"
#include "body/samples.hpp"
#include "check.hpp"
#include "model/basis.hpp"

using namespace softffd;

namespace {

const Lattice patched{.counts = {7, 4, 10}, .origin = {1, -2, 0.5}, .size = {2, 1, 3}, .lobatto = true};
const Lattice even{.counts = patched.counts, .origin = patched.origin, .size = patched.size};

}  // namespace

TEST(control_points_of_a_body_at_rest_stand_at_equal_distances) {
  Points control_points;
  lobatto::to_control_points(patched, rest_positions(patched), control_points);
  CHECK(distance(control_points, rest_positions(even)) < 1e-14);
}

TEST(nodes_are_where_the_bezier_volumes_of_the_control_points_have_them) {
  const Lattice one{.lobatto = true};
  const Points nodes = scattered(one, 0.3), rest = rest_positions(one);
  Points control_points;
  lobatto::to_control_points(one, nodes, control_points);
  for (int p = 0; p < one.points(); ++p) {
    const Embedding node = embed(Basis::bezier, one, row(rest, p));
    for (int axis = 0; axis < 3; ++axis) CHECK_NEAR(node(control_points.col(axis)), nodes(p, axis), 1e-13);
  }
}

TEST(forces_on_nodes_do_the_work_of_those_on_control_points) {
  const Points nodes = scattered(patched, 1), of_control_points = scattered(even, 1, 3);
  Points forces = of_control_points, control_points;
  lobatto::to_nodes(patched, forces);
  lobatto::to_control_points(patched, nodes, control_points);
  CHECK_NEAR((forces * nodes).sum(), (of_control_points * control_points).sum(), 1e-11);
}

TEST(weights_of_nodes_sum_to_one_reproduce_cubics_and_are_the_volume_of_the_box) {
  for (const double t : {0.0, 0.1, 1.0 / 3, 0.5, 0.77, 1.0}) {
    const Scalars weights = lobatto::interpolation(t, 10);
    double sum = 0, cube = 0;
    for (int i = 0; i < 10; ++i) sum += weights[i], cube += weights[i] * std::pow(lobatto::place(i, 10), 3);
    CHECK_NEAR(sum, 1, 1e-14);
    CHECK_NEAR(cube, t * t * t, 1e-14);
    CHECK(weights.minCoeff() > -0.1251);
  }
  const Scalars volume = lobatto::volume_fractions(patched);
  const Points x = rest_positions(patched);
  CHECK_NEAR(volume.sum(), 1, 1e-14);
  CHECK_NEAR((volume * x.col(0)).sum(), 2, 1e-14);
  CHECK_NEAR((volume * (x.col(2) - 2).square()).sum(), 9.0 / 12, 1e-14);
}

TEST(samples_of_a_solid_are_where_its_nodes_move_them) {
  const std::vector<Vec3> places{{1, -2, 0.5}, {1.3, -1.4, 1.1}, {2, -1.5, 1.5}, {2.9, -1, 3.4999}};
  const Samples samples(Basis::patches, patched, places);
  const Points rest = rest_positions(patched);
  Points moved = rest;
  for (int p = 0; p < patched.points(); ++p) moved(p, 0) += 0.1 * rest(p, 2) * rest(p, 2) * rest(p, 1);
  for (int s = 0; s < samples.count(); ++s) {
    const Vec3& at = places[s];
    CHECK((samples.at(s, rest) - at).norm() < 1e-14);
    CHECK_NEAR(samples.at(s, moved)[0], at[0] + 0.1 * at[2] * at[2] * at[1], 1e-13);
  }
}
