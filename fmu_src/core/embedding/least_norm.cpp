#include "embedding/least_norm.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {
namespace {

constexpr int most_cycles = 4 * most_vectors;  // largest number of cycles; some six are needed
constexpr double least_gain = 1e-6;            // a smaller decrease, relative to the squared norm, is not worth another cycle
constexpr double least_weight = 1e-14;         // weights up to this value become 0

using Matrix = double[most_vectors][most_vectors];

/// Solves a x = (1, .. 1) by Cholesky factorisation of a (`count` rows), which is overwritten. False if a is not positive definite.
bool solve(Matrix& a, int count, double* x) {
  for (int i = 0; i < count; ++i) {
    x[i] = 1;
    for (int j = 0; j <= i; ++j) {
      for (int k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      if (i == j && !(a[i][i] > 0)) return false;
      a[i][j] = i == j ? std::sqrt(a[i][i]) : a[i][j] / a[j][j];
      if (j < i) x[i] -= a[i][j] * x[j];
    }
    x[i] /= a[i][i];
  }
  for (int i = count - 1; i >= 0; --i) {
    for (int k = i + 1; k < count; ++k) x[i] -= a[k][i] * x[k];
    x[i] /= a[i][i];
  }
  return true;
}

struct Combination {
  Matrix products;
  std::vector<double> weights;
  std::vector<int> in;  // the vectors that have weights

  /// Moves towards the point of least norm in the plane through the vectors, as far as no weight is negative. Returns the fraction of the
  /// way, 1 for all of it.
  double step() {
    Matrix part;
    double goal[most_vectors], sum = 0, step = 1;
    const int count = int(in.size());
    for (int i = 0; i < count; ++i)
      for (int j = 0; j <= i; ++j) part[i][j] = products[in[i]][in[j]] + products[in[0]][in[0]];  // weights sum to 1: adds a constant
    if (!solve(part, count, goal)) return 1;
    for (int i = 0; i < count; ++i) sum += goal[i];
    for (int i = 0; i < count; ++i) {
      goal[i] /= sum;
      if (goal[i] <= 0) step = std::min(step, weights[in[i]] / (weights[in[i]] - goal[i]));
    }
    for (int i = 0; i < count; ++i) weights[in[i]] += step * (goal[i] - weights[in[i]]);
    for (const int s : in) weights[s] = weights[s] > least_weight ? weights[s] : 0;
    std::erase_if(in, [&](int s) { return weights[s] == 0; });
    return step;
  }
};

}  // namespace

std::vector<double> least_norm(int count, const std::function<const double*(int s)>& products, double enough) {
  Combination found;
  found.weights.assign(count, 0.0);
  found.weights[0] = 1;
  std::vector<double> along(count);
  for (int cycle = 0, to = 0; cycle < most_cycles; ++cycle) {
    std::copy_n(products(to), count, found.products[to]);
    found.in.push_back(to);
    while (found.step() < 1) {
    }
    double square = 0;
    std::fill(along.begin(), along.end(), 0.0);
    for (const int s : found.in)
      for (int t = 0; t < count; ++t) along[t] += found.weights[s] * found.products[s][t];
    for (const int s : found.in) square += found.weights[s] * along[s];
    if (std::sqrt(std::max(square, 0.0)) <= enough) return {};
    to = int(std::min_element(along.begin(), along.end()) - along.begin());
    if (along[to] >= (1 - least_gain) * square || found.weights[to] > 0) break;
  }
  double sum = 0;
  for (const double weight : found.weights) sum += weight;
  for (double& weight : found.weights) weight /= sum;
  return found.weights;
}

}  // namespace softffd
