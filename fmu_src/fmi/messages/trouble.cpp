#include "messages/trouble.hpp"

#include <algorithm>

#include "contact/surface/tangents.hpp"
#include "messages/logger.hpp"

namespace softffd::fmi {

namespace {

/// Depth behind a plane, as a fraction of the largest side of the box, up to which it is rounding.
constexpr double slight = 1e-9;
/// Distance of pinned points from the initial body, as a fraction of the largest side of the box, above which a warning is given.
constexpr double noticed_strain = 1e-6;

/// Returns the gap between an obstacle and a place [m].
double gap_of(const Plane& plane, const SolidPose& pose, const Vec3& place) {
  return (plane.solid() ? tangent(plane, pose, place) : HalfSpace(pose)).gap(place);
}

/// Returns the initial places that planes may meet [m]: samples of the surface, or the control points that no pin holds.
std::vector<Vec3> met_places(const Definition& d, const Points& start) {
  std::vector<Vec3> places;
  if (d.samples) {
    for (int s = 0; s < d.samples->count(); ++s) places.push_back(d.samples->at(s, start));
    return places;
  }
  std::vector<bool> pinned(d.lattice.points(), false);
  for (const PinDefinition& pin : d.pins)
    for (int p : pin.points) pinned[p] = true;
  for (int p = 0; p < d.lattice.points(); ++p)
    if (!pinned[p]) places.push_back(row(start, p));
  return places;
}

/// Returns the paths of those obstacles or pins, of their numbers, that `test` is true for.
template <class Part, class Test>
std::string paths(const std::vector<Part>& parts, Test&& test) {
  std::string text;
  for (std::size_t n = 0; n < parts.size(); ++n)
    if (test(n)) text += (text.empty() ? "" : " and ") + parts[n].path();
  return text;
}

/// Returns which pin is behind which obstacle at the start of a communication step or at its end; where that is not seen there, any.
std::string pinned_behind(const SceneFile& scene, const SoftBody& body, double step) {
  const Drive& drive = body.readings().drive;
  for (const double time : {body.state().time, body.state().time + step})
    for (std::size_t a = 0; a < scene.pins.size(); ++a) {
      const Frame frame = drive.pins[a].at(time);
      for (std::size_t q = 0; q < scene.planes.size(); ++q) {
        const SolidPose pose = drive.planes[q].pose_at(time);
        for (const Vec3& local : drive.pins[a].local) {
          const Vec3 place = frame.origin + frame.arm(local);
          if (gap_of(drive.planes[q], pose, place) < -slight * body.lattice().largest_side())
            return "a control point of " + scene.pins[a].path() + " is behind " + scene.planes[q].path();
        }
      }
    }
  return "a pinned control point is behind an obstacle";
}

}  // namespace

std::string trouble(StepStatus status, const SceneFile& scene, const SoftBody& body, double time, double step) {
  const std::string where = "at time " + number(time) + " s: ";
  const Settings& settings = body.settings;
  switch (status) {
    case StepStatus::ok:
    case StepStatus::contact_ahead:
    case StepStatus::beside_solid: return "done";
    case StepStatus::impossible_planes:
      return where + paths(scene.planes, [](std::size_t) { return true; }) +
             " leave a control point, a point of the surface or a free obstacle no feasible position; move or turn them so "
             "that they do not "
             "close on it";
    case StepStatus::pin_behind_plane:
      return where + pinned_behind(scene, body, step) + "; the motions of the pin and the obstacle contradict each other";
    case StepStatus::zero_normal:
      return where + paths(scene.planes, [&](std::size_t q) { return settings.planes[q].normal.isZero(0); }) +
             ": the normal is the zero vector; wanted any other vector";
    case StepStatus::zero_orientation:
      return where +
             paths(scene.pins,
                   [&](std::size_t a) { return std::ranges::none_of(settings.pins[a].orientation, [](double c) { return c != 0; }); }) +
             ": the orientation is the zero quaternion; wanted any other, e.g. (1, 0, 0, 0)";
    case StepStatus::undecided: return where + without_direction(scene, body);
    case StepStatus::too_much_work:
      return where + "a communication step of " + number(step) + " s needs more work than [solver] most_work = " + number(scene.most_work) +
             " allows" + (body.came() > 0 ? ", as was found at time " + number(time + body.came()) + " s" : "") +
             "; use shorter communication steps, a longer solver.step, less stiffness per mass, a larger tolerance or a larger most_work";
    case StepStatus::not_finite:
      if (step == 0) return where + "a number is not finite: masses, forces, speeds or stiffness are too large";
      return where + "the result of a communication step of " + number(step) +
             " s is not finite, not even with smaller internal steps: forces, speeds or stiffness are too large";
  }
  return where + "unknown trouble";
}

std::string without_direction(const SceneFile& scene, const SoftBody& body) {
  const bool drawn_flat = (scene.definition.stretch.array() == 0).any();
  const std::string behind = drawn_flat ? "" : behind_planes(scene, body);
  const std::string why = behind.empty() ? "control points that they connect coincide" : behind;
  std::string cure = behind.empty() ? "separate the points (no 0 in initial.stretch)" : clear_of_planes;
  if (behind.empty() && !(body.settings.step > 0)) cure += ", or set solver.step, to which no tolerance applies";
  return "springs have zero length, because " + why +
         ": rounding would decide the direction of their force, and no tolerance could be met; " + cure;
}

std::string behind_planes(const SceneFile& scene, const SoftBody& body) {
  const Definition& d = scene.definition;
  if (body.settings.method == Method::central_difference) return {};  // this method moves no points out
  const Points start = start_positions(d, body.settings.rotation);
  const std::vector<Vec3> places = met_places(d, start);
  const std::string what = d.samples ? " point of the surface" : " control point",
                    those = d.samples ? " points of the surface" : what + "s";
  std::string text;
  for (std::size_t q = 0; q < scene.planes.size(); ++q) {
    Plane plane{body.settings.planes[q]};
    plane.normal /= plane.normal.stableNorm();
    const SolidPose pose = plane.pose_at(plane.since);
    int count = 0;
    double deepest = 0;
    for (const Vec3& place : places) {
      const double depth = -gap_of(plane, pose, place);
      if (!(depth > slight * d.lattice.largest_side())) continue;
      ++count;
      deepest = std::max(deepest, depth);
    }
    if (count > 0)
      text += (text.empty() ? "" : " and ") + std::to_string(count) + (count > 1 ? those + " start" : what + " starts") +
              (plane.solid() ? " in " : " behind ") + scene.planes[q].kind() + " " + scene.planes[q].name + ", by up to " +
              estimate(deepest) + " m";
  }
  return text.empty() ? text : text + ", and are moved out at the start";
}

std::vector<std::string> strained_by_pins(const SceneFile& scene, const SoftBody& body) {
  Definition unstretched = scene.definition;
  unstretched.stretch = Vec3::Ones();
  const Points start = start_positions(unstretched, body.settings.rotation);
  std::vector<std::string> texts;
  for (std::size_t a = 0; a < scene.pins.size(); ++a) {
    double farthest = 0;
    for (int p : unstretched.pins[a].points) farthest = std::max(farthest, (row(body.state().x, p) - row(start, p)).norm());
    if (farthest > noticed_strain * body.lattice().largest_side())
      texts.push_back("pin " + scene.pins[a].name + " holds its control points up to " + estimate(farthest) +
                      " m from the initial position of the body, which strains the body beside them; " +
                      (scene.pins[a].moved_by_input
                           ? "start the pin at its rest pose, or move the body there with initial.offset"
                           : "a fixed pin stays at its rest pose: set initial.offset to 0, or give the pin motion = \"input\""));
  }
  return texts;
}

}  // namespace softffd::fmi
