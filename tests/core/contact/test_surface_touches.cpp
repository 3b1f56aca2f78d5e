#include <algorithm>
#include <cstring>

#include "falling_box.hpp"
#include "icosphere.hpp"
#include "methods/leapfrog.hpp"

using namespace softffd;

namespace {

/// A box with m x m samples on each of its six faces.
std::shared_ptr<const Samples> faces(const Lattice& lattice, int m) {
  std::vector<Vec3> places;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int j = 0; j < m; ++j)
        for (int i = 0; i < m; ++i) {
          Vec3 part = Vec3::Zero();
          part[axis] = side;
          part[(axis + 1) % 3] = i / double(m - 1);
          part[(axis + 2) % 3] = j / double(m - 1);
          const Vec3 place = lattice.origin + part.cwiseProduct(lattice.size);
          if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
        }
  return std::make_shared<const Samples>(Basis::bezier, lattice, places);
}

FallingBox cube(double k, int planes, int samples = 4) {
  FallingBox scene(k, planes);
  scene.body.samples = faces(scene.lattice, samples);
  return scene;
}

FallingBox sphere(double k, int planes, int level = 3) {
  FallingBox scene(k, planes);
  scene.body.samples = std::make_shared<const Samples>(Basis::bezier, Lattice{}, icosphere(level, 0.4, {0.5, 0.5, 0.5}));
  return scene;
}

}  // namespace

TEST(a_cube_on_its_samples_presses_with_its_weight) {
  for (const double mu : {0.0, 0.4})
    for (const double k : {1e5, 1e7, 1e9}) {
      FallingBox scene = cube(k, 1);
      scene.damp(0.02);
      scene.around.planes[0].friction = mu;
      CheckedRun runner(scene);
      for (int i = 0; i < 300; ++i)
        if (!runner.step(scene, 0.01)) return;
      const Vec3 force = runner.force(0, 0.01);
      std::printf("  mu %g k %g: force off by %.3g N, gap %.3g m, %.3g iterations a step, %lld halvings\n", mu, k, -force.z() - g,
                  scene.least_gap(runner.time), double(runner.method.iterations()) / 300, (long long)runner.method.halvings());
      CHECK_NEAR(-force.z(), g, 1e-12 * g);
      CHECK(scene.least_gap(runner.time) >= -1e-12);
      CHECK(runner.method.halvings() == 0);
    }
}

TEST(a_sphere_on_its_samples_comes_to_rest) {
  for (const double mu : {0.0, 0.4})
    for (const double k : {1e5, 1e7, 1e9}) {
      FallingBox scene = sphere(k, 1);
      scene.damp(0.3 * 64 / 64);
      scene.around.planes[0].friction = mu;
      scene.state.x.col(2) -= scene.least_gap(0);
      CheckedRun runner(scene);
      for (int i = 0; i < 600; ++i)
        if (!runner.step(scene, 0.01)) return;
      const Vec3 force = runner.force(0, 0.01);
      std::printf("  mu %g k %g: force off by %.3g N, gap %.3g m, %.3g iterations a step, %lld halvings, speed %.3g\n", mu, k,
                  -force.z() - g, scene.least_gap(runner.time), double(runner.method.iterations()) / 600,
                  (long long)runner.method.halvings(), scene.state.v.abs().maxCoeff());
    }
}

TEST(friction_of_samples_holds_or_brakes) {
  for (const double degrees : {20.0, 25.0, 35.0})
    for (const double k : {1e5, 1e7, 1e9})
      for (const int m : {4, 8}) {
        FallingBox scene = cube(k, 1, m);
        scene.around.planes[0].friction = 0.4;
        const double angle = degrees * M_PI / 180, mu = 0.4;
        const Vec3 gravity = g * Vec3(std::sin(angle), 0, -std::cos(angle));
        for (int axis = 0; axis < 3; ++axis) scene.around.force.col(axis) = gravity[axis] * scene.body.mass;
        CheckedRun runner(scene);
        const double x0 = FallingBox::mean(scene.state.x).x();
        double halfway = 0;
        for (int i = 0; i < 200; ++i) {
          if (i == 100) halfway = FallingBox::mean(scene.state.x).x();
          if (!runner.step(scene, 0.01)) break;
        }
        const double v = FallingBox::mean(scene.state.v).x(), exact = std::max(0.0, 2 * g * (std::sin(angle) - mu * std::cos(angle)));
        std::printf("  %g degrees k %g m %d: v %.9g, exact %.9g, crept %.3g, moved %.3g, %.3g it, %lld halvings, fac %lld\n", degrees, k, m,
                    v, exact, FallingBox::mean(scene.state.x).x() - halfway, FallingBox::mean(scene.state.x).x() - x0,
                    double(runner.method.iterations()) / 200, (long long)runner.method.halvings(),
                    (long long)runner.method.factorizations());
      }
}
