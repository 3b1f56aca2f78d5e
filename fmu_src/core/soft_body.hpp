/// The soft object: the settings that a host may change between communication steps, and the communication step itself.
#pragma once
#include <memory>
#include <optional>

#include "contact/surface/surface_contact.hpp"
#include "definition.hpp"
#include "forces/cells.hpp"
#include "forces/regions.hpp"
#include "forces/solid.hpp"
#include "stepping/propagator.hpp"
#include "watch/means.hpp"
#include "watch/readings.hpp"
#include "watch/sensors.hpp"

namespace softffd {

struct Material {
  double mass = 1;  ///< total [kg]
  Stiffness stiffness;
  double modulus = 0;           ///< Young's modulus [Pa]
  double poissons_ratio = 0;    ///< of a solid [1]
  double damping = 0;           ///< nodal viscous drag per control point [N s/m]
  double internal_damping = 0;  ///< stiffness-proportional; of springs the ratio of dashpot to stiffness [s]
  bool operator==(const Material&) const = default;
};

/// Values that a host may set between steps. Vectors have the sizes of the definition.
struct Settings : Material {
  Vec3 gravity = Vec3::Zero();  ///< [m/s2]
  Method method = Method::automatic;
  Vec3 rotation = Vec3::Zero();              ///< initial rotation vector about the centre of the box [rad]
  double tolerance = 1e-4;                   ///< error aimed at, relative to the largest side of the box
  double step = 0;                           ///< internal step [s]; 0: set by stability and tolerance
  double step_factor = 1;                    ///< factor of the internal step that would be taken otherwise [1]
  double horizon = 1;                        ///< length of the run [s]
  double most_work = thresholds::most_work;  ///< per communication step, in evaluations of the spring forces of 4 x 4 x 4 points
  MarkedPoints force;                        ///< loads and point forces at the communication point (points, 3) [N]
  MarkedPoints force_rate;                   ///< their time derivative [N/s]
  std::array<MarkedPoints, 2> force_bend;    ///< their second and third derivatives [N/s2, N/s3]
  std::vector<PlaneMotion> planes;
  std::vector<PinMotion> pins;
  std::vector<FreeLoad> free;
};

class SoftBody {
 public:
  explicit SoftBody(Definition definition);

  Settings settings;                                                ///< take effect at the next `initialize` or `advance`
  const Material& material() const { return material_; }            ///< the material in effect
  bool material_waits() const { return !(material_ == settings); }  ///< a changed material takes effect at the next step

  /// Sets up the initial state at time t0; positions behind planes are moved onto them.
  StepStatus initialize(double t0);
  /// Takes one communication step of length H > 0 [s]. On failure the state is as before.
  StepStatus advance(double H);

  const State& state() const { return now_.physical.motion; }
  /// Positions and velocities of the control points [m], [m/s], also for a solid, whose state holds nodes. Valid until the next step.
  const Points& positions() const { return shown(now_.physical.motion.x, shown_positions_); }
  const Points& velocities() const { return shown(now_.physical.motion.v, shown_velocities_); }
  /// Return the state of free body k at its own centre of mass, and its angular velocity [rad/s].
  FreeState free_body(int k) const { return drive_.free[k].own(state().free[k]); }
  Vec3 angular_velocity(int k) const { return drive_.free[k].spin(state().free[k]); }
  /// A snapshot to read or copy.
  const Run& run() const { return now_; }
  /// Continues from a snapshot of the same definition. `settings` and start_time must be those of the snapshot's moment, with all values
  /// that had taken effect.
  void restore(const Run& run, double start_time);
  /// Returns the finite-element solid; null for a body of springs.
  const Solid* solid() const { return definition_.solid() ? static_cast<const Solid*>(model_.body.energies.front().get()) : nullptr; }
  const Lattice& lattice() const { return definition_.lattice; }
  /// Returns the origin of pin a's frame at rest [m].
  Vec3 pin_origin(int a) const { return pin_origins_[a]; }

  /// Returns a view of what can be read of the body in its current state.
  Readings readings() const { return {model_, drive_, cells_, now_, before_, settings.gravity, settings.step, moved_}; }
  /// Returns the divisor of the internal steps of the last communication step; above 1 if larger steps did not give a finite result.
  double divided() const { return divided_; }
  /// Returns the work of the last call, in evaluations of the spring forces.
  double work_done() const { return work_done_; }
  /// Returns the time that the first attempt of the last communication step covered [s].
  double came() const { return came_; }
  /// Number of matrices factored since the start.
  Count factorizations() const { return propagator_.factorizations(); }

 private:
  /// Values of the control points from those of the nodes, kept until the next step, because outputs are read one by one.
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
  /// Finds what touches the obstacles, and takes the means of contact over a time [s]; 0: those before stay.
  void look_at_planes(double of_means);
  bool place_pins(bool book);
  double potential_energy() const { return readings().elastic_energy() + readings().gravity_energy(); }
  void take_material();
  StepStatus advance_from_here(double H, double step_factor, bool changed, bool stand_ins);

  /// Sources of the outside forces.
  struct Loads {
    std::array<Count, 4> marks{};
    Vec3 gravity = Vec3::Zero();
    Count version = -1;  ///< version of the body
    bool operator==(const Loads&) const = default;
  };

  Definition definition_;
  Model model_;
  Drive drive_;
  Regions regions_;
  std::vector<Vec3> pin_origins_;
  Cells cells_;
  Run now_, before_;  ///< before_: at the start of the last communication step, if there was any
  Propagator propagator_;
  Contact jumps_;
  std::unique_ptr<SurfaceContact> surface_;  ///< jumps of obstacles that meet samples of the surface; else null
  std::unique_ptr<Sensors> sensors_;         ///< null if the scene has none
  std::unique_ptr<FollowedPoints> followed_;
  Points begin_;          ///< positions at the start of the communication step, if they differ from those of before_
  Loads loads_{};         ///< sources of drive_.force
  Count force_mark_ = 0;  ///< mark of drive_.force
  double divided_ = 1;    ///< divisor that the last communication step's internal steps needed for a result
  double work_done_ = 0;  ///< work of the last call
  double came_ = 0;       ///< time that the last call's first attempt covered [s]
  Material material_;     ///< the material in effect
  mutable Shown shown_positions_, shown_velocities_;
  double start_time_ = 0;  ///< [s]
  bool struck_ = false;    ///< pins changed the velocity of points at once then
  bool moved_ = false;     ///< pins or planes moved points at once when the last communication step began
};

}  // namespace softffd
