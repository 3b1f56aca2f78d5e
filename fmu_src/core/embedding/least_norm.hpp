/// The combination of some vectors that is nearest to the origin.
#pragma once
#include <functional>
#include <vector>

namespace softffd {

constexpr int most_vectors = 16;

/// Shares alpha_s >= 0 of `count` vectors d_s, at most `most_vectors`, that sum to 1 and minimise |sum of alpha_s d_s|; nothing where this
/// is seen to be at most `enough`. The first vector is where it begins, best the shortest. products: the products d_s . d_t with all t.
///
/// Wolfe (1976), Finding the nearest point in a polytope. Each cycle adds the vector that is least along the combination, and goes to the
/// point nearest to the origin in the plane through all that have shares, as far as these stay positive.
std::vector<double> least_norm(int count, const std::function<const double*(int s)>& products, double enough);

}  // namespace softffd
