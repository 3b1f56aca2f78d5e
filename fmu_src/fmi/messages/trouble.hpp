/// Texts that say why a body cannot start or continue.
#pragma once
#include "resource/scene_file.hpp"

namespace softffd::fmi {

/// Returns what the status means, with the time and the length of the communication step [s].
std::string trouble(StepStatus status, const SceneFile& scene, const SoftBody& body, double time, double step);

/// Returns why springs have no direction, and the remedy.
std::string without_direction(const SceneFile& scene, const SoftBody& body);

/// Returns how many points start behind planes or in solids, from where they are moved at once, and how deep; empty if there are none.
std::string behind_planes(const SceneFile& scene, const SoftBody& body);

/// Returns a text for each pin that does not start where the body does.
std::vector<std::string> strained_by_pins(const SceneFile& scene, const SoftBody& body);

/// The remedy for points behind planes.
inline constexpr const char* clear_of_planes = "to start clear of it, change the obstacle or initial.offset, or reverse a plane's normal";

}  // namespace softffd::fmi
