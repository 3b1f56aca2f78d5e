/// What a scene defines of a soft object for good, and what follows from it alone: its body, its pins, where it starts, a run of its sizes.
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
  std::optional<Vec3> origin = {};  ///< of the frame at rest [m]; absent: the centroid of the points' rest positions
};

/// Creation data of a soft object: a resolved scene.
struct Definition {
  Lattice lattice;
  Topology topology = Topology::distinct;
  bool of_modulus = false;  ///< springs by the material's modulus, of the topology `distinct`, in place of its stiffness
  bool solid() const { return lattice.lobatto; }  ///< finite elements by the modulus and Poisson's ratio, in place of springs
  std::vector<double> mass;                       ///< per control point, or node of a solid, > 0 [kg]
  std::vector<double> weight;                     ///< what gravity pulls at, >= 0 [kg]; empty: the mass
  std::vector<Region> regions;                    ///< later ones win
  std::vector<PinDefinition> pins;
  std::vector<FreeBody> free = {};  ///< obstacles first
  int planes = 0;
  bool solids = false;                          ///< the last of these are
  std::shared_ptr<const Samples> samples = {};  ///< of the surface, by which planes are met; null: by the control points
  Sensed sensed = {};
  double volume_stiffness = 0;                                    ///< >= 0 [Pa]; 0: absent
  Vec3 stretch = Vec3::Ones(), offset = Vec3::Zero();             ///< x0 = origin + stretch (X - origin) + offset, then turned
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();  ///< [m/s], [rad/s], both of the centre of the box at x0
  bool spin_about_mass = false;                                   ///< both of the centre of mass instead
  bool watch_energy = false;                                      ///< accumulate dissipated energy and work
  std::shared_ptr<Team> team = {};                                ///< shares the spring forces; null: one thread works them out
};

/// Before pins and planes move points (points, 3) [m]. rotation: vector [rad] by which the body starts turned about the centre of its box.
Points start_positions(const Definition& definition, const Vec3& rotation);
/// Is this pin the frame of a free body?
bool is_free(const Definition& definition, int pin);
/// The pose at the start of this pin's frame that is at `origin` [m] at rest: it turns with the body; a free one is stretched and moved
/// along with it too.
PinMotion start_pose(const Definition& definition, int pin, const Vec3& origin, const Vec3& rotation);
/// Of the box at the start, before it is turned [m].
Vec3 start_centre(const Definition& definition);

/// The body without a material: masses are the definition's, and the energies have none yet.
Body make_body(const Definition& definition);
/// origin: where its frame is at rest [m].
Pin make_pin(const Definition& definition, const PinDefinition& source, Vec3& origin);
/// Of the sizes that the definition asks for.
Run empty_run(const Definition& definition);

}  // namespace softffd
