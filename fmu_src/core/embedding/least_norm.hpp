/// The convex combination of some vectors that is nearest to the origin.
#pragma once
#include <functional>
#include <vector>

namespace softffd {

constexpr int most_vectors = 16;

/// Returns weights alpha_s >= 0 of `count` <= `most_vectors` vectors d_s that sum to 1 and minimise |sum of alpha_s d_s|; nothing if this
/// norm is found to be at most `enough`. The search begins at the first vector, best the shortest. products(s): all d_s . d_t.
///
/// Wolfe (1976), Finding the nearest point in a polytope. Each cycle adds the vector that is least along the combination, and moves to
/// the point nearest to the origin in the plane through all vectors that have weights, as far as the weights stay positive.
std::vector<double> least_norm(int count, const std::function<const double*(int s)>& products, double enough);

}  // namespace softffd
