#include "definition.hpp"

#include <algorithm>

#include "contact/free/solid_samples.hpp"
#include "forces/solid.hpp"
#include "forces/springs.hpp"
#include "forces/volume.hpp"
#include "matrix/lattice_matrix.hpp"

namespace softffd {

namespace {

/// Largest number of active contact constraints that the state keeps. Of more, it keeps the first; the others are found again.
constexpr int most_surface_rows = 512;

std::vector<bool> pinned_points(const Definition& definition) {
  std::vector<bool> pinned(definition.lattice.points(), false);
  for (const PinDefinition& pin : definition.pins)
    for (int p : pin.points) pinned[p] = true;
  return pinned;
}

/// Returns the points of the pins that are frames of free parts; empty if there is no such part.
std::vector<bool> yielding_points(const Definition& definition) {
  std::vector<bool> yielding;
  for (const FreeBody& part : definition.free) {
    if (part.pin < 0) continue;
    yielding.resize(definition.lattice.points(), false);
    for (int p : definition.pins[part.pin].points) yielding[p] = true;
  }
  return yielding;
}

/// Returns the initial place of a point that is at `rest` at rest, before the body is turned [m].
Vec3 placed(const Definition& definition, const Vec3& rest) {
  return definition.lattice.origin + definition.stretch.cwiseProduct(rest - definition.lattice.origin) + definition.offset;
}

}  // namespace

Vec3 start_centre(const Definition& definition) {
  const Lattice& lattice = definition.lattice;
  return lattice.origin + definition.stretch.cwiseProduct(0.5 * lattice.size) + definition.offset;
}

Points start_positions(const Definition& definition, const Vec3& rotation) {
  const Lattice& lattice = definition.lattice;
  Points x = rest_positions(lattice);
  for (int p = 0; p < lattice.points(); ++p) set_row(x, p, placed(definition, row(x, p)));
  if (rotation.isZero(0)) return x;
  const Vec3 centre = start_centre(definition);
  for (int p = 0; p < lattice.points(); ++p) set_row(x, p, centre + rotated(rotation, row(x, p) - centre));
  return x;
}

bool is_free(const Definition& definition, int pin) {
  return std::ranges::find(definition.free, pin, &FreeBody::pin) != definition.free.end();
}

PinMotion start_pose(const Definition& definition, int pin, const Vec3& origin, const Vec3& rotation) {
  const Lattice& lattice = definition.lattice;
  const bool free = is_free(definition, pin);
  const Vec3 from = free ? placed(definition, origin) : origin, centre = free ? start_centre(definition) : lattice.centre();
  PinMotion pose;
  pose.position = rotation.isZero(0) ? from : centre + rotated(rotation, from - centre);
  pose.orientation = quaternion(rotation);
  return pose;
}

Body make_body(const Definition& definition) {
  const int n = definition.lattice.points();
  Body body{.energies = {}, .mass = {}, .damping = {}, .pinned = pinned_points(definition)};
  body.yielding = yielding_points(definition);
  if (!body.yielding.empty())
    for (int p = 0; p < n; ++p) body.not_yielding.push_back(body.pinned[p] && !body.yielding[p]);
  if (definition.solid())
    body.energies.push_back(std::make_shared<Solid>(definition.lattice));
  else
    body.energies.push_back(std::make_shared<Springs>(definition.lattice, definition.topology, definition.team));
  if (definition.volume_stiffness > 0) body.energies.push_back(std::make_shared<Volume>(definition.lattice, definition.volume_stiffness));
  body.mass = Eigen::Map<const Scalars>(definition.mass.data(), n);
  body.weight = body.mass;
  body.damping = Scalars::Zero(n);
  body.explicit_alone = !LatticeMatrix::exists(definition.lattice);
  body.length = definition.lattice.largest_side();
  body.samples = definition.samples;
  const auto free = std::ranges::count_if(definition.free, [](const FreeBody& each) { return each.plane >= 0; });
  if (body.samples && free > 0 && free < definition.planes) {  // free obstacles meet the others
    auto samples = std::make_shared<Samples>(*body.samples);
    samples->add_idle(most_of_solid * definition.planes);
    body.samples = samples;
  }
  return body;
}

Pin make_pin(const Definition& definition, const PinDefinition& source, Vec3& origin) {
  const Points rest = rest_positions(definition.lattice);
  Pin pin;
  pin.points = source.points;
  origin.setZero();
  for (int p : source.points) origin += row(rest, p) / double(source.points.size());
  origin = source.origin.value_or(origin);
  for (int p : source.points) pin.local.push_back(row(rest, p) - origin);
  return pin;
}

Run empty_run(const Definition& definition) {
  const int n = definition.lattice.points();
  Run run;
  run.physical.exchange.planes.resize(definition.planes);
  run.physical.exchange.pins.resize(definition.pins.size());
  const auto& [basis, patches, followed, areas] = definition.sensed;
  run.physical.exchange.points.resize(followed.size());
  if (!patches.empty()) run.physical.exchange.touched.assign(definition.planes, Points::Zero(int(areas.size()), 3));
  for (const Patch& patch : patches) run.sensors.push_back({.taxels = Points::Zero(patch.taxel_count(), 3)});
  run.contacts.resize(definition.planes);
  run.plane_reactions.resize(definition.planes);
  run.pin_reactions.resize(definition.pins.size());
  run.centres.resize(definition.planes, Vec3::Zero());
  State& motion = run.physical.motion;
  for (Points* points : {&motion.x, &motion.v, &motion.spring}) points->setZero(n, 3);
  if (definition.planes > 0) run.control.neighbour.x = run.control.neighbour.v = Points::Zero(n, 3);
  for (MarkedPoints* points : {&motion.previous, &run.control.bound_x, &run.control.factored.x, &run.outside})
    points->change().setZero(n, 3);
  if (definition.solid() || (definition.samples && definition.planes > 0)) run.control.in_contact.x.change().setZero(n, 3);
  motion.free.resize(definition.free.size());
  run.control.neighbour.free.resize(definition.free.size());
  if (!definition.samples && !definition.solid()) {
    motion.holds.assign(definition.planes, Points::Zero(n, 3));
  } else if (definition.planes > 0) {
    const int touching = definition.samples ? definition.samples->count() : n;
    const int rows = std::min({most_surface_rows, 3 * n, touching * definition.planes});
    motion.held_rows = {std::vector<Count>(rows, -1), Points::Zero(rows, 3)};
    SurfaceRows& surface = run.physical.surface;
    if (definition.samples) {
      surface.drift = surface.close = motion.held_rows.rows;
      surface.drift_friction = surface.close_friction = motion.held_rows.forces;
    }
  }
  return run;
}

}  // namespace softffd
