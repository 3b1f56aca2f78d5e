/// Beside an obstacle: how the body stands to it, and what a difference of two states will amount to at the end of the run.
#pragma once
#include <limits>

#include "body/rigid_motion.hpp"
#include "kit/step_context.hpp"

namespace softffd {

/// How long a difference of velocities lasts [s]: a body that is pressed on loses what velocity it has at the next landings, and what it
/// slides with by friction.
struct Outlook {
  Vec3 normal;  ///< of the nearest obstacle
  double along_normal, along_plane;
  double left;      ///< of the run
  double pressing;  ///< acceleration towards the obstacle [m/s2]
  /// Accelerations along the obstacle of a body that nothing else holds: what drives it, and what friction gives at most [m/s2].
  double drive = 0, grip = std::numeric_limits<double>::infinity();
  bool slides_on() const { return drive >= grip; }
  /// Of a body that slides: the velocity along the obstacle that it is given with each unit of that along the normal.
  Vec3 rub = Vec3::Zero();
  /// Of a body that falls over: how many times what two states differ by grows until it lands or the run ends, and the way of its outermost
  /// point until then, beyond which they cannot differ more [m].
  double growth = 1, sweep = 0;
};

/// Of the run, over which errors add up [s].
double left_of_run(const StepContext& context);
/// Of the slowest vibration, about [s].
double slowest_period(const StepContext& context);
/// The obstacle that a point, or sample, is nearest to, or furthest behind. The drive has planes.
struct NearestObstacle {
  const Plane* plane = nullptr;
  HalfSpace obstacle;                                    ///< now
  double gap = std::numeric_limits<double>::infinity();  ///< [m]
};
NearestObstacle nearest_obstacle(const StepContext& context, const State& state);
/// What any obstacle has been pressed by most since these impulses on them, along its normals [N s].
double pressed_since(const StepContext& context, const std::vector<Impulse>& before);
/// Kinetic energy of the motion that is not rigid [J].
double kinetic_deformation(const Body& body, const State& state);
/// Speed at which a body comes to the nearest obstacle, with what its turning adds [m/s]. radius: of its outermost point [m].
double approach_speed(const StepContext& context, const State& state, const RigidMotion& rigid, double radius);

/// The drive has planes.
Outlook outlook(const StepContext& context, const State& state);
/// The same of a stiff body, which may fall over.
Outlook outlook_of_stiff(const StepContext& context, const State& state);
/// An impact begins: books what the phase of the vibrations that the body brings, of this energy [J] and frequency [rad/s], not being known
/// may add to the error. Each impact has a phase of its own. known: error of the places at the impact [m].
void book_unknown_phase(const StepContext& context, const State& state, double energy, double frequency, double known);
/// By how much two states of free bodies differ now, at the farthest of what turns with each, and how fast that grows where they fly.
struct FreeApart {
  double place = 0, speed = 0;  ///< [m, m/s]
};
FreeApart free_apart(const StepContext& context, const FreeMotion& body, const FreeState& a, const FreeState& b);
/// How long a difference of its velocity lasts where it swings with the object [s].
double swing_time(const StepContext& context, const FreeMotion& body);
/// Of free bodies, the part of what two states differ by now, and what their velocities make of it [m]: what touches the object, or always
/// where `swing`, swings with it, and so does a part that is bonded to a body that other pins hold; what flies goes on.
double free_bodies_apart(const StepContext& context, const State& a, const State& b, bool swing);
/// What two states will differ by at the end of the run, its size infinite where one is not finite.
FinalError final_error(const StepContext& context, const State& a, const State& b, const Outlook& ahead, double stretch = 0);
/// Of that size, of a body that no pin holds, what is left when what is across the obstacle and what rings has died away [m].
double lasting_part(const StepContext& context, const State& a, const State& b, const Outlook& ahead, double size);

}  // namespace softffd
