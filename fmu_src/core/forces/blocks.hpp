/// 3 x 3 blocks of matrices of the lattice.
#pragma once
#include <Eigen/Core>

namespace softffd {

using Mat3 = Eigen::Matrix3d;

/// Index of entry (a, b) of a symmetric block among its six components xx yy zz xy xz yz.
inline constexpr int component[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};

}  // namespace softffd
