#include "forces/cells.hpp"

#include <Eigen/Geometry>
#include <limits>
#include <utility>

#include "machine/lanes.hpp"

namespace softffd {

namespace kernels {

namespace loops {

// Components of the three edges of a corner are named by axis of the edge and coordinate.

INNER void edge(int lanes, double per_length, In here, In there, Out e) {
  for (int p = 0; p < lanes; ++p) e[p] = (there[p] - here[p]) * per_length;
}

INNER void pull(int lanes, double limit, In absent, In xx, In xy, In xz, In yx, In yy, In yz, In zx, In zy, In zz, Out pxx, Out pxy,
                Out pxz, Out pyx, Out pyy, Out pyz, Out pzx, Out pzy, Out pzz) {
  for (int p = 0; p < lanes; ++p) {
    const double ax = yy[p] * zz[p] - yz[p] * zy[p], ay = yz[p] * zx[p] - yx[p] * zz[p], az = yx[p] * zy[p] - yy[p] * zx[p];
    const double missing = limit - (xx[p] * ax + xy[p] * ay + xz[p] * az) - absent[p];
    const double positive = missing > 0.0 ? missing : 0.0, w = positive * positive;
    pxx[p] += w * ax;
    pxy[p] += w * ay;
    pxz[p] += w * az;
    pyx[p] += w * (zy[p] * xz[p] - zz[p] * xy[p]);
    pyy[p] += w * (zz[p] * xx[p] - zx[p] * xz[p]);
    pyz[p] += w * (zx[p] * xy[p] - zy[p] * xx[p]);
    pzx[p] += w * (xy[p] * yz[p] - xz[p] * yy[p]);
    pzy[p] += w * (xz[p] * yx[p] - xx[p] * yz[p]);
    pzz[p] += w * (xx[p] * yy[p] - xy[p] * yx[p]);
  }
}

INNER void add_scaled(int lanes, double factor, In pull, Out f) {
  for (int p = 0; p < lanes; ++p) f[p] += factor * pull[p];
}

/// Index offsets of the edges along x, y and z of corner number `corner`, for lane 0.
struct CornerEdges {
  int x, y, z;
  CornerEdges(const int offset[3], int corner) {
    const int a = (corner & 1) * offset[0], b = (corner >> 1 & 1) * offset[1], c = (corner >> 2) * offset[2];
    x = b + c;
    y = a + c;
    z = a + b;
  }
};

/// Computes the edges (9 * points), by axis of the edge, then by coordinate.
INNER void make_edges(int points, const int offset[3], const double per_length[3], const double* x, double* edges) {
  for (int axis = 0; axis < 3; ++axis)
    for (int coordinate = 0; coordinate < 3; ++coordinate) {
      const double* here = x + coordinate * points;
      edge(points - offset[axis], per_length[axis], here, here + offset[axis], edges + (3 * axis + coordinate) * points);
    }
}

template <int n>
INNER Triple<n> edge_between(const Triple<n>& here, const Triple<n>& there, double per_length) {
  return {(there.x - here.x) * per_length, (there.y - here.y) * per_length, (there.z - here.z) * per_length};
}

template <int n>
INNER Lanes<n> determinant(const Triple<n>& x, const Triple<n>& y, const Triple<n>& z) {
  const Lanes<n> ax = y.y * z.z - y.z * z.y, ay = y.z * z.x - y.x * z.z, az = y.x * z.y - y.y * z.x;
  return x.x * ax + x.y * ay + x.z * az;
}

/// Lowers `smallest` to the smallest corner volumes of the n cells from the lane of x on. Bit `axis` of a corner's number is its place
/// along that axis.
template <int n>
INNER void lowest(int points, const int offset[3], const double per_length[3], const double* x, Lanes<n>& smallest) {
  Triple<n> corner[8], along[3][4];
  for (int c = 0; c < 8; ++c) corner[c] = load<n>(x + (c & 1) * offset[0] + (c >> 1 & 1) * offset[1] + (c >> 2) * offset[2], points);
  for (int e = 0; e < 4; ++e) {
    const int low = e & 1, high = e >> 1;
    along[0][e] = edge_between<n>(corner[2 * e], corner[2 * e + 1], per_length[0]);
    along[1][e] = edge_between<n>(corner[low + 4 * high], corner[low + 4 * high + 2], per_length[1]);
    along[2][e] = edge_between<n>(corner[e], corner[e + 4], per_length[2]);
  }
  for (int c = 0; c < 8; ++c) {
    const int a = c & 1, b = c >> 1 & 1, h = c >> 2;
    const Lanes<n> volume = determinant<n>(along[0][b + 2 * h], along[1][a + 2 * h], along[2][a + 2 * b]);
    smallest = volume < smallest ? volume : smallest;
  }
}

/// Computes the smallest corner volume of every cell (lanes).
template <int n>
INNER void corner_volumes(int points, int lanes, const int offset[3], const double per_length[3], const double* absent, const double* x,
                          double* smallest) {
  const auto take = [&]<int m>(int p) INLINED {
    Lanes<m> least = Lanes<m>{} + std::numeric_limits<double>::infinity();
    lowest<m>(points, offset, per_length, x + p, least);
    store<m>(smallest + p, least + load<m>(absent + p));
  };
  int p = 0;
  for (; p + n <= lanes; p += n) take.template operator()<n>(p);
  for (; p < lanes; ++p) take.template operator()<1>(p);
}

INNER bool any_below(int lanes, double limit, const double* values) {
  int below = 0;
  for (int p = 0; p < lanes; ++p) below |= values[p] < limit;
  return below != 0;
}

/// pulls (9 * points) = sums over the corners with J < limit of (limit - J)^2 dJ/dedge; f += factor times the pulls on the edges' ends.
INNER void add_squares(int points, int lanes, const int offset[3], const double factor[3], double limit, const double* absent,
                       const double* edges, double* pulls, double* f) {
  for (int i = 0; i < 9 * points; ++i) pulls[i] = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const CornerEdges at(offset, corner);
    const double *ex = edges + at.x, *ey = edges + 3 * points + at.y, *ez = edges + 6 * points + at.z;
    double *px = pulls + at.x, *py = pulls + 3 * points + at.y, *pz = pulls + 6 * points + at.z;
    pull(lanes, limit, absent, ex, ex + points, ex + 2 * points, ey, ey + points, ey + 2 * points, ez, ez + points, ez + 2 * points, px,
         px + points, px + 2 * points, py, py + points, py + 2 * points, pz, pz + points, pz + 2 * points);
  }
  for (int axis = 0; axis < 3; ++axis)
    for (int coordinate = 0; coordinate < 3; ++coordinate) {
      const double* pull = pulls + (3 * axis + coordinate) * points;
      double* first = f + coordinate * points;
      add_scaled(points - offset[axis], -factor[axis], pull, first);
      add_scaled(points - offset[axis], factor[axis], pull, first + offset[axis]);
    }
}

}  // namespace loops

const auto make_edges = chosen<loops::make_edges>();
const auto corner_volumes = chosen<loops::corner_volumes<2>, loops::corner_volumes<4>, loops::corner_volumes<8>>();
const auto any_below = chosen<loops::any_below>();
const auto add_squares = chosen<loops::add_squares>();

}  // namespace kernels

Cells::Cells(const Lattice& lattice) : points_(lattice.points()) {
  const auto& n = lattice.counts;
  offset_ = {lattice.index(1, 0, 0), lattice.index(0, 1, 0), lattice.index(0, 0, 1)};
  for (int axis = 0; axis < 3; ++axis) per_length_[axis] = (n[axis] - 1) / lattice.size[axis];
  absent_.setConstant(points_ - lattice.index(1, 1, 1), std::numeric_limits<double>::infinity());
  smallest_ = absent_;
  for (int k = 0; k + 1 < n[2]; ++k)
    for (int j = 0; j + 1 < n[1]; ++j)
      for (int i = 0; i + 1 < n[0]; ++i) absent_[lattice.index(i, j, k)] = 0;
}

const Scalars& Cells::smallest(const Points& x) const {
  kernels::corner_volumes(points_, lanes(), offset_.data(), per_length_.data(), absent_.data(), x.data(), smallest_.data());
  return smallest_;
}

bool Cells::any_below(double limit, const Points& x) const { return kernels::any_below(lanes(), limit, smallest(x).data()); }

int Cells::folded(const Points& x) const { return int((smallest(x) <= 0).count()); }

Cells::Corner Cells::corner(const Points& x, int lane, int a, int b, int c) const {
  const std::array<int, 3> place{a, b, c};
  Corner corner;
  int& here = corner.points[0] = lane;
  for (int axis = 0; axis < 3; ++axis) here += place[axis] * offset_[axis];
  std::array<Vec3, 3> edge;
  for (int axis = 0; axis < 3; ++axis) {
    const int way = place[axis] == 0 ? 1 : -1;
    corner.points[axis + 1] = here + way * offset_[axis];
    edge[axis] = way * per_length_[axis] * (row(x, corner.points[axis + 1]) - row(x, here));
  }
  corner.volume = edge[0].dot(edge[1].cross(edge[2]));
  corner.gradient[0].setZero();
  for (int axis = 0; axis < 3; ++axis) {
    const int way = place[axis] == 0 ? 1 : -1;
    corner.gradient[axis + 1] = way * per_length_[axis] * edge[(axis + 1) % 3].cross(edge[(axis + 2) % 3]);
    corner.gradient[0] -= corner.gradient[axis + 1];
  }
  return corner;
}

void Cells::add_squares(double limit, double factor, const Points& x, Points& f) const {
  if (!any_below(limit, x)) return;
  if (edges_.size() == 0) edges_ = pulls_ = Scalars::Zero(9 * points_);
  kernels::make_edges(points_, offset_.data(), per_length_.data(), x.data(), edges_.data());
  const std::array<double, 3> scaled{factor * per_length_[0], factor * per_length_[1], factor * per_length_[2]};
  kernels::add_squares(points_, lanes(), offset_.data(), scaled.data(), limit, absent_.data(), edges_.data(), pulls_.data(), f.data());
}

}  // namespace softffd
