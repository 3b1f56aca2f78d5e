/// Why a body does not start or go on, in words.
#pragma once
#include "resource/scene_file.hpp"

namespace softffd::fmi {

/// What the status means, with the time and the length of the communication step [s].
std::string trouble(StepStatus status, const SceneFile& scene, const SoftBody& body, double time, double step);

/// Why springs have no direction, and what helps.
std::string without_direction(const SceneFile& scene, const SoftBody& body);

/// Which control points the start has behind obstacle planes, whence they are moved at once; empty where there are none.
std::string behind_planes(const SceneFile& scene, const SoftBody& body);

/// A text for each pin that does not begin where the body does.
std::vector<std::string> strained_by_pins(const SceneFile& scene, const SoftBody& body);

/// What to do about points behind planes.
inline constexpr const char* clear_of_planes = "to start clear of it, change the obstacle or initial.offset, or reverse a plane's normal";

}  // namespace softffd::fmi
