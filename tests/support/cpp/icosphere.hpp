/// Vertices of a sphere: those of an icosahedron, whose edges are halved and put on the sphere a number of times, turned so that none is a
/// pole. 10 * 4^level + 2 of them.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <map>
#include <vector>

#include "model/types.hpp"

namespace softffd {

inline std::vector<Vec3> icosphere(int level, double radius, const Vec3& centre) {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> places;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-golden, golden})
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 place = Vec3::Zero();
        place[(axis + 1) % 3] = a;
        place[(axis + 2) % 3] = b;
        places.push_back(place.normalized());
      }
  std::vector<std::array<int, 3>> faces;
  const auto apart = [&](int a, int b) { return (places[a] - places[b]).norm() < 1.1; };  // edges are 1.05 long
  for (int a = 0; a < 12; ++a)
    for (int b = a + 1; b < 12; ++b)
      for (int c = b + 1; c < 12; ++c)
        if (apart(a, b) && apart(b, c) && apart(a, c)) faces.push_back({a, b, c});
  for (; level > 0; --level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), int(places.size()));
      if (fresh) places.push_back((places[a] + places[b]).normalized());
      return at->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(0.3, Vec3::UnitX()) * Eigen::AngleAxisd(0.7, Vec3::UnitZ()));
  for (Vec3& place : places) place = centre + radius * (turn * place);
  return places;
}

}  // namespace softffd
