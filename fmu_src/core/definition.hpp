/// What a scene defines permanently of a soft object, and what follows from it alone: body, pins, initial positions, a run of its sizes.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "body/body.hpp"
#include "forces/regions.hpp"
#include "model/free_body.hpp"
#include "model/pin.hpp"
#include "model/run.hpp"
#include "watch/sensed.hpp"

namespace softffd {

struct PinDefinition {
  std::vector<int> points;
  std::optional<Vec3> origin = {};  ///< origin of the frame at rest [m]; absent: the centroid of the points' rest positions
};

/// Creation data of a soft object: a resolved scene.
struct Definition {
  Lattice lattice;
  Topology topology = Topology::distinct;
  bool of_modulus = false;  ///< springs follow from the material's modulus, in the topology `distinct`, in place of its stiffness
  bool solid() const { return lattice.lobatto; }  ///< finite elements with the modulus and Poisson's ratio, in place of springs
  std::vector<double> mass;                       ///< per control point, or node of a solid, > 0 [kg]
  std::vector<double> weight;                     ///< mass that gravity acts on, >= 0 [kg]; empty: `mass`
  std::vector<Region> regions;                    ///< later ones win
  std::vector<PinDefinition> pins;
  std::vector<FreeBody> free = {};  ///< obstacles first
  int planes = 0;
  bool solids = false;                          ///< the last of the obstacles are solids
  std::shared_ptr<const Samples> samples = {};  ///< samples of the surface, which touch obstacles; null: the control points do
  Sensed sensed = {};
  double volume_stiffness = 0;                                    ///< >= 0 [Pa]; 0: absent
  Vec3 stretch = Vec3::Ones(), offset = Vec3::Zero();             ///< x0 = origin + stretch (X - origin) + offset, then turned
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();  ///< [m/s], [rad/s], both at the centre of the box at x0
  bool spin_about_mass = false;                                   ///< both at the centre of mass instead
  bool watch_energy = false;                                      ///< accumulate dissipated energy and work
  std::shared_ptr<Team> team = {};                                ///< threads that share the spring forces; null: one thread computes them
};

/// Returns positions before pins and planes move points, (points, 3) [m]. rotation: initial rotation vector about the box's centre [rad].
Points start_positions(const Definition& definition, const Vec3& rotation);
/// True if this pin is the frame of a free body.
bool is_free(const Definition& definition, int pin);
/// Returns the initial pose of a pin's frame whose origin at rest is `origin` [m]. The frame turns with the body; the origin of a free
/// frame also follows the body's stretch and offset.
PinMotion start_pose(const Definition& definition, int pin, const Vec3& origin, const Vec3& rotation);
/// Returns the initial centre of the box, before it is turned [m].
Vec3 start_centre(const Definition& definition);

/// Returns the body without a material: the masses are those of the definition, and the energies have no material yet.
Body make_body(const Definition& definition);
/// Returns a pin. origin: receives the origin of its frame at rest [m].
Pin make_pin(const Definition& definition, const PinDefinition& source, Vec3& origin);
/// Returns a run with arrays of the sizes that the definition asks for.
Run empty_run(const Definition& definition);

}  // namespace softffd
