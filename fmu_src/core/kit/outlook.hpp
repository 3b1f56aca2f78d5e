/// How the body stands to an obstacle, and what a difference of two states will amount to at the end of the run.
#pragma once
#include <limits>

#include "body/rigid_motion.hpp"
#include "kit/step_context.hpp"

namespace softffd {

/// How long a difference of velocities lasts along the normal and along the obstacle [s]. A body that is pressed on loses its normal
/// velocity at the next landings, and its sliding velocity by friction.
struct Outlook {
  Vec3 normal;  ///< of the nearest obstacle
  double along_normal, along_plane;
  double left;      ///< rest of the run, or less where drag takes velocities sooner [s]
  double pressing;  ///< acceleration towards the obstacle [m/s2]
  /// Accelerations along the obstacle of a body that nothing else holds [m/s2]: the driving one, and the largest that friction can give.
  double drive = 0, grip = std::numeric_limits<double>::infinity();
  bool slides_on() const { return drive >= grip; }
  /// If the body slides: the velocity along the obstacle that each unit of normal velocity gives the body [1].
  Vec3 rub = Vec3::Zero();
  /// If the body falls over: the factor by which a difference of two states grows until the body lands or the run ends, and the way of its
  /// outermost point until then, beyond which two states cannot differ more [m].
  double growth = 1, sweep = 0;
};

/// Rest of the run, over which errors add up [s].
double left_of_run(const StepContext& context);
/// Approximate period of the slowest vibration [s].
double slowest_period(const StepContext& context);
/// Time in which damping takes the energy of the slowest vibration to 1 / e [s]; infinite without damping.
double vibration_lasts(const StepContext& context);
/// The obstacle that a control point, or sample, is nearest to or furthest behind. The drive must have planes.
struct NearestObstacle {
  const Plane* plane = nullptr;
  HalfSpace obstacle;                                    ///< at the time of the state
  double gap = std::numeric_limits<double>::infinity();  ///< [m]
};
NearestObstacle nearest_obstacle(const StepContext& context, const State& state);
/// True if the body, with its points at x, is off all obstacles, and with internal damping off solids by more than its positions err: a
/// vertex that slides on a solid leaves it by the square of its way in a step, and comes back within a few steps; that is no flight.
bool in_flight(const StepContext& context, double time, const Points& x);
/// Largest normal impulse that any obstacle has received since the impulses `before` [N s].
double pressed_since(const StepContext& context, const std::vector<Impulse>& before);
/// Kinetic energy of the motion that is not rigid [J].
double kinetic_deformation(const Body& body, const State& state);
/// Speed at which the body approaches the nearest obstacle, with a part of its speed of turning [m/s]. radius: of its outermost point [m].
double approach_speed(const StepContext& context, const State& state, const RigidMotion& rigid, double radius);

/// Returns the outlook at a state. The drive must have planes.
Outlook outlook(const StepContext& context, const State& state);
/// The same for a stiff body, which may fall over.
Outlook outlook_of_stiff(const StepContext& context, const State& state);
/// An impact begins: books the error that may arise as the phase of the body's vibrations, of this energy [J] and frequency [rad/s], is
/// unknown. Each impact has its own phase: squares add up. known: error of the positions at the impact [m].
void book_unknown_phase(const StepContext& context, const State& state, double energy, double frequency, double known);
/// Distance of two states of a free body, at the farthest point that turns with the body, and its rate of growth in flight.
struct FreeApart {
  double place = 0, speed = 0;  ///< [m, m/s]
};
FreeApart free_apart(const StepContext& context, const FreeMotion& body, const FreeState& a, const FreeState& b);
/// How long a difference of the free body's velocity lasts while it swings with the object [s].
double swing_time(const StepContext& context, const FreeMotion& body);
/// Final error of free bodies [m]: their present difference, or what the difference of their velocities makes of it. A free body swings
/// with the object if it touches the object, or always if `swing`; so does a part that is bonded to a body that other pins hold. A free
/// body in flight flies on.
double free_bodies_apart(const StepContext& context, const State& a, const State& b, bool swing);
/// Final error of two states; its size is infinite if a value is not finite.
FinalError final_error(const StepContext& context, const State& a, const State& b, const Outlook& ahead, double stretch = 0);
/// Part of that size [m] that is left when motion across the obstacle and ringing have died away, for a body that no pin holds.
double lasting_part(const StepContext& context, const State& a, const State& b, const Outlook& ahead, double size);

}  // namespace softffd
