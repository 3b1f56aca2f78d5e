#include "embedding/samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "embedding/least_norm.hpp"
#include "machine/lanes.hpp"

namespace softffd::samples {
namespace {

using Index = long long;
using Numbers = std::vector<double>;
using Indices = std::vector<Index>;

constexpr Index block = 64;                           // largest number of vertices in a block
constexpr Index around = 96, nearest = most_vectors;  // samples considered around a block; how many of them a vertex is compared with
constexpr double rounding = 1e-7;                     // error of a distance where squares of weights, which are 1 at most, cancel
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A vertex: the weights of each axis (3, n), and W . W.
struct Place {
  Numbers weights;
  double square;
};

/// Many vertices: the same numbers, (3, n, count) and (count).
struct Places {
  Index n, count;
  Numbers weights, squares;

  Place of(Index place) const {
    Place found{Numbers(3 * n), squares[place]};
    for (Index r = 0; r < 3 * n; ++r) found.weights[r] = weights[r * count + place];
    return found;
  }
  Places some(const Indices& chosen) const {
    Places found{n, Index(chosen.size()), {}, {}};
    found.weights.reserve(3 * n * found.count), found.squares.reserve(found.count);
    for (Index r = 0; r < 3 * n; ++r)
      for (const Index place : chosen) found.weights.push_back(weights[r * count + place]);
    for (const Index place : chosen) found.squares.push_back(squares[place]);
    return found;
  }
};

template <int lanes>
INNER void products(const Places& places, kernels::In q, Index& at, double* found) {
  const Index n = places.n, count = places.count;
  for (; at + lanes <= count; at += lanes) {
    kernels::Lanes<lanes> sum[3] = {};
    const double* row = places.weights.data() + at;
    for (Index i = 0; i < n; ++i)
      for (int axis = 0; axis < 3; ++axis)
        if (const double weight = q[axis * n + i]; weight != 0) sum[axis] += kernels::load<lanes>(row + (axis * n + i) * count) * weight;
    kernels::store<lanes>(found + at, sum[0] * sum[1] * sum[2]);
  }
}

/// Computes W_p . W_q for all places p.
void products(const Places& places, const Place& q, Numbers& found) {
  found.resize(places.count);
  Index at = 0;
  products<4>(places, q.weights.data(), at, found.data());
  products<1>(places, q.weights.data(), at, found.data());
}

/// Computes |W_p - W_q|^2 for all places p.
void squared_distances(const Places& places, const Place& q, Numbers& found) {
  products(places, q, found);
  for (Index at = 0; at < places.count; ++at) found[at] = places.squares[at] + q.square - 2 * found[at];
}

double largest(const Numbers& values) { return *std::max_element(values.begin(), values.end()); }

Places all_places(Index n, Index count, const double* axes) {
  Places whole{n, count, {axes, axes + 3 * n * count}, Numbers(count, 1.0)};
  for (Index at = 0; at < count; ++at)
    for (int axis = 0; axis < 3; ++axis) {
      double sum = 0;
      for (Index i = 0; i < n; ++i) sum += axes[(axis * n + i) * count + at] * axes[(axis * n + i) * count + at];
      whole.squares[at] *= sum;
    }
  return whole;
}

/// A vertex with its place in the lattice.
struct Cell {
  double at[3];
  Index vertex;
};

/// Halves a set of cells along its longest side until each part is a block. The first vertex of a block is the one nearest to its middle.
void cut(Cell* begin, Cell* end, std::vector<Indices>& blocks) {
  double low[3], high[3], middle[3] = {}, side[3];
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = infinity, high[axis] = -infinity;
    for (const Cell* cell = begin; cell < end; ++cell) {
      low[axis] = std::min(low[axis], cell->at[axis]), high[axis] = std::max(high[axis], cell->at[axis]);
      middle[axis] += cell->at[axis] / double(end - begin);
    }
    side[axis] = high[axis] - low[axis];
  }
  if (end - begin > block) {
    const auto longest = std::max_element(side, side + 3) - side;
    Cell* half = begin + (end - begin) / 2;
    std::nth_element(begin, half, end, [longest](const Cell& a, const Cell& b) {
      return a.at[longest] < b.at[longest] || (a.at[longest] == b.at[longest] && a.vertex < b.vertex);
    });
    cut(begin, half, blocks);
    cut(half, end, blocks);
    return;
  }
  std::pair<double, Index> least{infinity, 0};
  blocks.emplace_back();
  for (const Cell* cell = begin; cell < end; ++cell) {
    double off = 0;
    for (int axis = 0; axis < 3; ++axis) off += (cell->at[axis] - middle[axis]) * (cell->at[axis] - middle[axis]);
    least = std::min(least, {off, cell - begin});
    blocks.back().push_back(cell->vertex);
  }
  std::swap(blocks.back()[0], blocks.back()[least.second]);
}

/// Returns all places in blocks of places that are near each other at rest.
std::vector<Indices> blocks_of(const Places& places) {
  std::vector<Cell> cells(places.count);
  for (Index at = 0; at < places.count; ++at) {
    cells[at] = {{}, at};
    for (Index r = 0; r < 3 * places.n; ++r) cells[at].at[r / places.n] += double(r % places.n) * places.weights[r * places.count + at];
  }
  std::vector<Indices> blocks;
  cut(cells.data(), cells.data() + cells.size(), blocks);
  return blocks;
}

/// Vertices near each other, and their distances from the nearest of all vertices chosen.
struct Block {
  Indices own;
  Places members;
  Numbers distances;  // to the nearest vertex chosen, squared, like `farthest` and `reach`
  double radius, farthest = infinity, reach = infinity;

  void compare(const Place& chosen, Numbers& found) {
    squared_distances(members, chosen, found);
    for (std::size_t v = 0; v < found.size(); ++v) distances[v] = std::min(distances[v], found[v]);
    farthest = largest(distances);
    const double within = std::sqrt(std::max(farthest, 0.0)) + radius + rounding;
    reach = within * within;
  }
};

void farthest_first(const Places& whole, Index first, Index count, Index* order) {
  std::vector<Block> blocks;
  Indices middles;
  Numbers found, off;
  for (const Indices& own : blocks_of(whole)) {
    Places members = whole.some(own);
    squared_distances(members, members.of(0), found);
    blocks.push_back({own, std::move(members), Numbers(own.size(), infinity), std::sqrt(std::max(largest(found), 0.0))});
    middles.push_back(own[0]);
  }
  const Places middle = whole.some(middles);
  order[0] = first;
  for (Index n = 1; n < count; ++n) {
    const Place last = whole.of(order[n - 1]);
    squared_distances(middle, last, off);
    double most = -infinity;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      if (off[b] < blocks[b].reach) blocks[b].compare(last, found);
      most = std::max(most, blocks[b].farthest);
    }
    order[n] = whole.count;
    for (const Block& each : blocks)
      for (std::size_t v = 0; each.farthest == most && v < each.own.size(); ++v)
        if (each.distances[v] == most) order[n] = std::min(order[n], each.own[v]);
  }
}

/// Returns the places with the `count` smallest values, or all places, the smallest first.
Indices least(const Numbers& values, Index count) {
  std::vector<std::pair<double, Index>> order(values.size());
  for (std::size_t at = 0; at < values.size(); ++at) order[at] = {values[at], Index(at)};
  const auto end = order.begin() + std::min<std::size_t>(count, values.size());
  std::partial_sort(order.begin(), end, order.end());
  Indices found;
  for (auto each = order.begin(); each < end; ++each) found.push_back(each->second);
  return found;
}

/// Returns e_v of a vertex from the samples near it, or `enough` if |.|_1 <= sqrt(n^3) |.|_2 shows that e_v is at most `enough`.
double behind(const Places& samples, const Place& q, double enough) {
  const Index n = samples.n;
  Numbers aim, row;
  products(samples, q, aim);
  const auto products_of_differences = [&](int s) -> const double* {
    products(samples, samples.of(s), row);
    for (Index t = 0; t < samples.count; ++t) row[t] += q.square - aim[s] - aim[t];
    return row.data();
  };
  const Numbers of_samples = least_norm(int(samples.count), products_of_differences, 2 * enough / std::sqrt(double(n * n * n)) - rounding);
  if (of_samples.empty()) return enough;
  std::vector<std::pair<Numbers, double>> parts{{q.weights, 1.0}};
  for (Index s = 0; s < samples.count; ++s)
    if (of_samples[s] > 0) parts.emplace_back(samples.of(s).weights, -of_samples[s]);
  Numbers difference(n), total(n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      std::fill(difference.begin(), difference.end(), 0.0);
      for (const auto& [weights, weight_of] : parts) {
        const double factor = weight_of * weights[i] * weights[n + j];
        for (Index k = 0; factor != 0 && k < n; ++k) difference[k] += factor * weights[2 * n + k];
      }
      for (Index k = 0; k < n; ++k) total[k] += std::abs(difference[k]);
    }
  for (Index k = 1; k < n; ++k) total[0] += total[k];
  return total[0] / 2;
}

double most_behind(const Places& whole, const Indices& samples, double allowed) {
  const Places chosen = whole.some(samples);
  std::vector<bool> is_sample(whole.count);
  for (const Index s : samples) is_sample[s] = true;
  Numbers found;
  double most = 0;
  for (const Indices& own : blocks_of(whole)) {
    squared_distances(chosen, whole.of(own[0]), found);
    const Places near = chosen.some(least(found, around));
    for (const Index v : own) {
      if (is_sample[v]) continue;
      const Place q = whole.of(v);
      const auto compared = [&](const Places& with) {
        squared_distances(with, q, found);
        return behind(with.some(least(found, nearest)), q, most);
      };
      if (const double rough = compared(near); rough > most) most = std::max(most, std::min(rough, compared(chosen)));
      if (most > allowed) return most;
    }
  }
  return most;
}

}  // namespace
}  // namespace softffd::samples

void softffd_farthest_first(int n, long long vertices, const double* axes, long long first, long long count, long long* order) {
  using namespace softffd::samples;
  farthest_first(all_places(n, vertices, axes), first, count, order);
}

double softffd_most_behind(int n, long long vertices, const double* axes, long long count, const long long* samples, double allowed) {
  using namespace softffd::samples;
  return most_behind(all_places(n, vertices, axes), Indices(samples, samples + count), allowed);
}
