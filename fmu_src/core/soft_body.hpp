/// The soft object: what a scene defines, what a host may change between communication steps, and the step itself.
#pragma once
#include <memory>
#include <optional>

#include "contact/contact.hpp"
#include "forces/cells.hpp"
#include "stepping/propagator.hpp"
#include "watch/energy_watch.hpp"
#include "watch/vibration.hpp"

namespace softffd {

/// Overrides of a [[region]]; absent ones leave what is there.
struct Region {
  std::vector<int> points;
  std::optional<double> stiffness;  ///< >= 0 [N/m]
  std::optional<double> damping;    ///< >= 0 [N s/m]
};

struct PinDefinition {
  std::vector<int> points;
};

/// Creation data of a soft object: a resolved scene.
struct Definition {
  Lattice lattice;
  Topology topology = Topology::distinct;
  std::vector<double> mass;     ///< per control point, > 0 [kg]
  std::vector<Region> regions;  ///< later ones win
  std::vector<PinDefinition> pins;
  int planes = 0;
  double volume_stiffness = 0;                                    ///< >= 0 [Pa]; 0: absent
  Vec3 stretch = Vec3::Ones(), offset = Vec3::Zero();             ///< x0 = origin + stretch (X - origin) + offset
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();  ///< [m/s], [rad/s] about the centre of the box at x0
  bool watch_energy = false;                                      ///< accumulate dissipated energy and work
};

/// Before pins and planes move points (points, 3) [m].
Points start_positions(const Definition& definition);

struct Material {
  double mass = 1;  ///< total [kg]
  Stiffness stiffness;
  double damping = 0;  ///< per control point [N s/m]
};

/// Values that a host may set between steps. Vectors have the sizes of the definition.
struct Settings : Material {
  Vec3 gravity = Vec3::Zero();  ///< [m/s2]
  Method method = Method::automatic;
  double tolerance = 1e-4;           ///< error aimed at, relative to the largest side of the box
  double step = 0;                   ///< internal step [s]; 0: by stability and tolerance
  double step_factor = 1;            ///< of the internal step that would be taken otherwise
  double horizon = 1;                ///< length of the run [s]
  Points force;                      ///< loads and point forces at the communication point (points, 3) [N]
  Points force_rate;                 ///< their time derivative [N/s]
  std::array<Points, 2> force_bend;  ///< their second and third [N/s2, N/s3]
  struct PlaneInput {
    Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ(), velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();
    double friction = 0;
    bool moved_by_input = false;  ///< the pose belongs to the communication point; otherwise to the start time
    Vec3 acceleration = Vec3::Zero(), angular_acceleration = Vec3::Zero(), normal_rate = Vec3::Zero();
  };
  std::vector<PlaneInput> planes;
  struct PinInput {
    Vec3 position = Vec3::Zero();
    std::array<double, 4> orientation{1, 0, 0, 0};
    Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();
    Vec3 acceleration = Vec3::Zero(), angular_acceleration = Vec3::Zero();
    std::array<double, 4> orientation_rate{};
  };
  std::vector<PinInput> pins;
};

class SoftBody {
 public:
  explicit SoftBody(Definition definition);

  Settings settings;                                      ///< take effect at the next `initialize` or `advance`
  void settings_changed() { stale_ = true; }              ///< call after changing mass, stiffness or damping
  const Material& material() const { return material_; }  ///< in effect
  bool material_waits() const { return stale_; }

  /// Sets up the initial state at time t0; positions behind planes are moved onto them.
  StepStatus initialize(double t0);
  /// One communication step of length H > 0. On failure the state is as before.
  StepStatus advance(double H);

  const State& state() const { return now_.path.motion; }
  /// A snapshot to read or copy.
  const Run& run() const { return now_; }
  /// Continues from a snapshot of the same definition. `settings` must be those of the snapshot's moment: the start time and all values
  /// that had taken effect.
  void restore(const Run& run, double start_time);
  const Lattice& lattice() const { return definition_.lattice; }
  /// Rest centroid of pin a's points: where its frame is at rest [m].
  Vec3 pin_origin(int a) const { return pin_origins_[a]; }

  Vec3 plane_reaction(int q) const { return now_.path.exchange.planes[q].force / now_.exchange_time; }
  Vec3 plane_torque(int q) const { return now_.path.exchange.planes[q].torque / now_.exchange_time; }
  Count plane_contacts(int q) const { return now_.contacts[q]; }
  Vec3 pin_reaction(int a) const { return now_.path.exchange.pins[a].force / now_.exchange_time; }
  Vec3 pin_torque(int a) const { return now_.path.exchange.pins[a].torque / now_.exchange_time; }
  double kinetic_energy() const;
  double elastic_energy() const { return model_.body.elastic_energy(now_.path.motion.x); }
  double gravity_energy() const;
  double dissipated_energy() const { return now_.dissipated; }
  double work() const { return now_.work; }
  Count steps() const { return now_.path.steps; }
  Count rejected() const { return now_.course.rejected; }
  Count contacts_resolved() const { return now_.contacts_resolved; }
  /// Largest stable internal step of the current state, by bound [s]; the largest finite number if nothing resists.
  double stable_step() const { return model_.stability.stable_step(model_.body, now_.path.motion.x); }
  /// Number of cells with a corner that is turned inside out or flat.
  int folded_cells() const { return cells_.folded(now_.path.motion.x); }
  /// Internal step of the last communication step [s].
  double internal_step() const { return now_.path.clock.h; }
  /// Did an undamped body rub against an obstacle in the last communication step, at steps by which friction can feed vibrations?
  bool rubs_undamped();
  /// How fast the body turned before or after the last communication step, whichever is faster, if implicit contact steps took it; they
  /// damp that. Otherwise 0 [rad/s].
  double damped_spin() const;
  /// Do springs have no length and would push their ends apart, if rounding gave them a direction?
  bool undecided() const;
  /// What the internal steps of the last communication step were divided by, because with larger ones its result was not finite.
  double divided() const { return divided_; }
  /// Has the body more energy than it was given?
  bool gains_energy() const { return alarm(now_.energy, model_.noise); }
  double gained_energy() const { return now_.energy.gained; }  ///< out of nothing [J]
  /// What an undamped body should have more [J]: lost by the method. Below 0: gained.
  double lost_energy() const;
  /// Size of vibrations of this energy [J], of a time scale up to this [s], in all of the body [m].
  double amplitude(double energy, double slowest) const { return softffd::amplitude(model_, energy, slowest); }
  bool damped() const { return model_.body.damped; }
  /// Factor of the usual internal step that automatic steps take since the usual one gained energy.
  double step_share() const { return now_.energy.step_factor; }
  bool beyond_help() const { return now_.energy.hopeless; }      ///< and smaller automatic steps do not help
  double largest_energy() const { return now_.energy.largest; }  ///< kinetic and elastic, so far [J]
  /// Number of matrices factored since the start.
  Count factorizations() const { return propagator_.factorizations(); }
  /// The vibration that the start of the last communication step set off by jumps of the forces and by `kink`, the share of the change of
  /// velocity that came at once; any that was there, if the step before was explicit.
  Vibration set_off(double kink, Points& scratch, Points& more) const;
  /// Share of a vibration that the slowest damping leaves after a time t [s].
  double remaining(double t) const;
  /// The method that took the last communication step, and why.
  Method method() const { return now_.course.method; }
  Reason reason() const { return now_.course.reason; }
  int spring_count() const { return model_.body.springs.count(); }

 private:
  void refresh_model();
  StepStatus refresh_drive();
  StepStatus clear_jumps(bool& moved);
  void count_contacts();
  bool place_pins(bool book);
  double potential_energy() const { return elastic_energy() + gravity_energy(); }
  void take_material();
  StepStatus advance_from_here(double H, double step_factor, bool changed);
  EnergyAccount account_at_start(bool changed) const;
  double open_account(bool changed, bool moved);
  void close_account(double booked);

  Definition definition_;
  Model model_;
  Drive drive_;
  std::vector<StiffnessOverride> overrides_;
  std::vector<Vec3> pin_origins_;
  Cells cells_;
  Run now_, before_;  ///< before: at the start of the last communication step
  Propagator propagator_;
  Contact jumps_;
  Points begin_;           ///< positions at the start of the communication step, where energy is watched
  bool stale_ = true;      ///< mass, stiffness or damping changed
  double divided_ = 1;     ///< by how much the last communication step's internal steps had to be divided to have a result
  Material material_;      ///< of the settings, what is in effect
  double start_time_ = 0;  ///< [s]
};

}  // namespace softffd
