/// The soft object: what a host may change between communication steps, and the step itself.
#pragma once
#include <memory>
#include <optional>

#include "contact/surface/surface_contact.hpp"
#include "definition.hpp"
#include "forces/cells.hpp"
#include "forces/regions.hpp"
#include "forces/solid.hpp"
#include "stepping/propagator.hpp"
#include "watch/readings.hpp"
#include "watch/sensors.hpp"

namespace softffd {

struct Material {
  double mass = 1;  ///< total [kg]
  Stiffness stiffness;
  double modulus = 0;           ///< Young's [Pa]
  double poissons_ratio = 0;    ///< of a solid [1]
  double damping = 0;           ///< per control point [N s/m]
  double internal_damping = 0;  ///< of springs: their dashpots by their stiffness [s]
  bool operator==(const Material&) const = default;
};

/// Values that a host may set between steps. Vectors have the sizes of the definition.
struct Settings : Material {
  Vec3 gravity = Vec3::Zero();  ///< [m/s2]
  Method method = Method::automatic;
  Vec3 rotation = Vec3::Zero();              ///< vector by which the body starts turned about the centre of its box [rad]
  double tolerance = 1e-4;                   ///< error aimed at, relative to the largest side of the box
  double step = 0;                           ///< internal step [s]; 0: by stability and tolerance
  double step_factor = 1;                    ///< of the internal step that would be taken otherwise
  double horizon = 1;                        ///< length of the run [s]
  double most_work = thresholds::most_work;  ///< of a communication step, in evaluations of the spring forces of 4 x 4 x 4 points
  MarkedPoints force;                        ///< loads and point forces at the communication point (points, 3) [N]
  MarkedPoints force_rate;                   ///< their time derivative [N/s]
  std::array<MarkedPoints, 2> force_bend;    ///< their second and third [N/s2, N/s3]
  std::vector<PlaneMotion> planes;
  std::vector<PinMotion> pins;
  std::vector<FreeLoad> free;
};

class SoftBody {
 public:
  explicit SoftBody(Definition definition);

  Settings settings;                                                ///< take effect at the next `initialize` or `advance`
  const Material& material() const { return material_; }            ///< in effect
  bool material_waits() const { return !(material_ == settings); }  ///< for the next step

  /// Sets up the initial state at time t0; positions behind planes are moved onto them.
  StepStatus initialize(double t0);
  /// One communication step of length H > 0. On failure the state is as before.
  StepStatus advance(double H);

  const State& state() const { return now_.physical.motion; }
  /// Control points, where the state has the nodes of a solid, as they are and move [m], [m/s]. Until the next step.
  const Points& positions() const { return shown(now_.physical.motion.x, shown_positions_); }
  const Points& velocities() const { return shown(now_.physical.motion.v, shown_velocities_); }
  /// Where free body k is by its own centre and how it moves, and its angular velocity [rad/s].
  FreeState free_body(int k) const { return drive_.free[k].own(state().free[k]); }
  Vec3 angular_velocity(int k) const { return drive_.free[k].spin(state().free[k]); }
  /// A snapshot to read or copy.
  const Run& run() const { return now_; }
  /// Continues from a snapshot of the same definition. `settings` must be those of the snapshot's moment: the start time and all values
  /// that had taken effect.
  void restore(const Run& run, double start_time);
  /// The solid that the body is; null of springs.
  const Solid* solid() const { return definition_.solid() ? static_cast<const Solid*>(model_.body.energies.front().get()) : nullptr; }
  const Lattice& lattice() const { return definition_.lattice; }
  /// Where pin a's frame is at rest [m].
  Vec3 pin_origin(int a) const { return pin_origins_[a]; }

  /// What can be read of the body as it is.
  Readings readings() const { return {model_, drive_, cells_, now_, before_, settings.gravity, settings.step, moved_}; }
  /// What the internal steps of the last communication step were divided by, because with larger ones its result was not finite.
  double divided() const { return divided_; }
  /// Work of the last call, in evaluations of the spring forces.
  double work_done() const { return work_done_; }
  /// How far the last communication step came at the first attempt [s].
  double came() const { return came_; }
  /// Number of matrices factored since the start.
  Count factorizations() const { return propagator_.factorizations(); }

 private:
  /// What can be shown of the nodes' values, kept until the next step: outputs are read one by one.
  struct Shown {
    Points control_points;
    bool known = false;
  };

  const Points& shown(const Points& values, Shown& kept) const;
  void forget_shown() { shown_positions_.known = shown_velocities_.known = false; }
  void refresh_model();
  StepStatus refresh_drive();
  void refresh_forces();
  void refresh_free_bodies();
  void start_free_bodies(const Vec3& centre);
  StepStatus clear_jumps(bool& moved);
  void look_at_planes();  ///< who touches them, and where they are pressed
  bool place_pins(bool book);
  double potential_energy() const { return readings().elastic_energy() + readings().gravity_energy(); }
  void take_material();
  StepStatus advance_from_here(double H, double step_factor, bool changed, bool stand_ins);

  /// What the outside forces come from.
  struct Loads {
    std::array<Count, 4> marks{};
    Vec3 gravity = Vec3::Zero();
    Count version = -1;  ///< of the body
    bool operator==(const Loads&) const = default;
  };

  Definition definition_;
  Model model_;
  Drive drive_;
  Regions regions_;
  std::vector<Vec3> pin_origins_;
  Cells cells_;
  Run now_, before_;  ///< before: at the start of the last communication step, if there was any
  Propagator propagator_;
  Contact jumps_;
  std::unique_ptr<SurfaceContact> surface_;  ///< where planes meet the surface: its jumps
  std::unique_ptr<Sensors> sensors_;         ///< where the scene has any
  std::unique_ptr<FollowedPoints> followed_;
  Points begin_;          ///< positions at the start of the communication step, where they are not those of before
  Loads loads_{};         ///< that drive_.force is of
  Count force_mark_ = 0;  ///< of drive_.force
  double divided_ = 1;    ///< by how much the last communication step's internal steps had to be divided to have a result
  double work_done_ = 0;  ///< of the last call
  double came_ = 0;       ///< by which the last call's first attempt moved the time [s]
  Material material_;     ///< of the settings, what is in effect
  mutable Shown shown_positions_, shown_velocities_;
  double start_time_ = 0;  ///< [s]
  bool moved_ = false;     ///< pins or planes moved points at once when the last communication step began
};

}  // namespace softffd
