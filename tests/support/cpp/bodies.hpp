/// What tests of the core begin with: bodies of equal masses, what acts on them, and positions that are out of shape.
#pragma once
#include <cmath>

#include "body/body.hpp"
#include "forces/springs.hpp"
#include "forces/volume.hpp"
#include "model/drive.hpp"
#include "model/state.hpp"

namespace softffd {

inline Springs& springs_of(const Body& body) { return static_cast<Springs&>(*body.energies.front()); }

/// Free and undamped: mass [kg] in equal parts, all springs of one stiffness [N/m].
inline Body even_body(const Lattice& lattice, double stiffness = 0, double mass = 1, Topology topology = Topology::distinct) {
  const int n = lattice.points();
  Body body{.energies = {}, .mass = Scalars::Constant(n, mass / n), .damping = Scalars::Zero(n), .pinned = std::vector<bool>(n, false)};
  body.energies.push_back(std::make_shared<Springs>(lattice, topology));
  springs_of(body).set_stiffness({stiffness, stiffness, stiffness}, {});
  return body;
}

/// No forces on so many points.
inline Drive no_forces(int points) {
  Drive drive;
  for (Points* each : {&drive.force, &drive.force_rate, &drive.force_bend[0], &drive.force_bend[1]}) each->setZero(points, 3);
  return drive;
}

inline State at_rest(const Lattice& lattice) {
  State state;
  state.x = rest_positions(lattice);
  for (Points* each : {&state.v, &state.spring}) each->setZero(lattice.points(), 3);
  return state;
}

/// A pin's frame at the mean of some points [m], which it holds from now on.
inline Pin pin_points(Body& body, const Points& x, const std::vector<int>& points, Pin pin = {}) {
  pin.points = points;
  for (int p : points) pin.position += row(x, p) / double(points.size());
  for (int p : points) {
    pin.local.push_back(row(x, p) - pin.position);
    body.pinned[p] = true;
  }
  return pin;
}

/// Points in disorder, up to the amplitude [m] from where they are in a lattice that is stretched.
inline Points crumpled(const Lattice& lattice, double amplitude = 0.2, double stretch = 1) {
  Points x = stretch * rest_positions(lattice);
  for (int p = 0; p < x.rows(); ++p)
    for (int a = 0; a < 3; ++a) x(p, a) += amplitude * std::sin(7.0 * p + 3.0 * a);
  return x;
}

/// A number between 0 and 1 without a pattern.
inline double scattered(int i) { return 0.5 + 0.5 * std::sin(12.9898 * i * i + 78.233 * i); }

inline Points scattered(const Lattice& lattice, double amplitude, int seed = 0) {
  Points x = rest_positions(lattice);
  for (int i = 0; i < x.size(); ++i) x(i) += 2 * amplitude * (scattered(100 * seed + i) - 0.5);
  return x;
}

/// Largest difference of any coordinate.
inline double distance(const Points& a, const Points& b) { return (a - b).abs().maxCoeff(); }

}  // namespace softffd
