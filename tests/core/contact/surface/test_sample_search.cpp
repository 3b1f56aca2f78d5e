#include "contact/surface/sample_search.hpp"

#include <algorithm>

#include "check.hpp"
#include "icosphere.hpp"
#include "random_numbers.hpp"

using namespace softffd;

TEST(the_list_holds_every_sample_behind_a_plane_and_searches_are_rare) {
  Random random;
  const Samples samples(Basis::bezier, {}, icosphere(3, 0.4, {0.5, 0.5, 0.5}));
  SampleSearch search(samples, 1, 1);
  const Points rest = rest_positions({});
  Points x = rest;
  int behind = 0;
  for (int step = 0; step < 2000; ++step) {
    for (Eigen::Index i = 0; i < x.size(); ++i) x(i) += random(-1e-4, 1e-4);
    const Vec3 normal = Vec3(std::sin(1e-3 * step), 0.3, 1).normalized();
    Scalars gaps(64);
    for (int p = 0; p < 64; ++p) gaps[p] = normal.dot(row(x, p)) - 0.35 + 0.1 * std::sin(2e-3 * step);
    if (!search.covers(0, gaps)) search.look(0, gaps, 1e-4);
    CHECK(search.covers(0, gaps));
    const std::vector<int>& near = search.near(0);
    CHECK(std::is_sorted(near.begin(), near.end()));
    for (int s = 0; s < samples.count(); ++s)
      if (samples.at(s, gaps.data()) < 0) {
        ++behind;
        CHECK(std::binary_search(near.begin(), near.end(), s));
      }
  }
  CHECK(behind > 1000);
  CHECK(search.searches() > 10 && search.searches() < 700);
}

TEST(nothing_is_near_a_plane_that_is_in_front_of_no_control_point) {
  const Samples samples(Basis::bezier, {}, icosphere(1, 0.4, {0.5, 0.5, 0.5}));
  SampleSearch search(samples, 1, 1);
  CHECK(search.covers(0, Scalars::Constant(64, 1e-3)));
  CHECK(search.near(0).empty());
  CHECK(!search.covers(0, Scalars::Constant(64, -1e-3)));
}
