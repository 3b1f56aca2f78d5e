#include "check.hpp"
#include "embedding/least_norm.hpp"

using namespace softffd;

namespace {

std::vector<double> shares_of(const std::vector<std::vector<double>>& vectors, double enough = -1) {
  std::vector<double> row(vectors.size());
  const auto products = [&](int s) -> const double* {
    for (std::size_t t = 0; t < row.size(); ++t) row[t] = vectors[s][0] * vectors[t][0] + vectors[s][1] * vectors[t][1];
    return row.data();
  };
  return least_norm(int(vectors.size()), products, enough);
}

}  // namespace

TEST(nearest_combination_is_found_at_an_end_on_an_edge_and_inside) {
  CHECK(shares_of({{1, 0}, {2, 1}, {2, -1}}) == std::vector<double>({1, 0, 0}));
  const std::vector<double> edge = shares_of({{2, 0}, {1, 3}, {1, -1}});
  CHECK_NEAR(edge[0], 0, 1e-12);
  CHECK_NEAR(edge[1], 0.25, 1e-12);
  CHECK_NEAR(edge[2], 0.75, 1e-12);
  const std::vector<double> inside = shares_of({{1, 0}, {-1, 1}, {-1, -1}, {-3, 0}});
  CHECK_NEAR(inside[0] - inside[1] - inside[2] - 3 * inside[3], 0, 1e-12);
  CHECK_NEAR(inside[1] - inside[2], 0, 1e-12);
  CHECK_NEAR(inside[0] + inside[1] + inside[2] + inside[3], 1, 1e-12);
}

TEST(combination_is_not_told_where_it_is_near_enough) {
  CHECK(shares_of({{1, 3}, {1, -1}}, 1.01).empty());
  CHECK(!shares_of({{1, 3}, {1, -1}}, 0.99).empty());
}

TEST(vectors_twice_are_one) {
  const std::vector<double> found = shares_of({{1, 1}, {1, 1}, {1, -1}, {1, -1}});
  CHECK_NEAR(found[0] + found[1], 0.5, 1e-12);
}
