/// A scene with nearly every variable that there is, and how tests ask for them.
#pragma once
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "instances.hpp"
#include "variables/variables.hpp"

namespace whole_scene {

using namespace softffd::fmi;

/// A scene with every part but those that its stiffness leaves no place for, boxes and sensors, which need a surface, and free bodies,
/// which leave few methods.
inline const std::string text = small_scene::Box{.side = 2, .mass = 0.25, .stiffness = 100, .initial = "1 1 1 0 0 0.5 1 0 0 0 0 0"}.text(
    "damping 0.05\ninternal_damping 0.001\ngravity 0 0 -9.81\ninitial_rotation 0 0 0\nplane ground fixed 0 0 0 0.1 0 1 0 0 0 0 0 0 "
    "0.4\nplane lid input 0 0 9 0 0 "
    "-1 0 0 -1 0 0 0 0.1\n"
    "pin foot fixed 0\npin hand input 7\npin arm input 3\npin_inputs position.z orientation.w\nload push 1 2\nforces 2 3\nvelocities "
    "5\nprobe nose 0.5 0.5 1\nprobe_outputs velocity acceleration maximum\nareas 0 0 -1 0 0 -1 0 0 -1 0 0 -1 0 0 1 0 0 1 0 0 1 0 0 1\n"
    "sensor sole 0 1 1 1 2 1 3 1\nsensor_taxels 1 2 0 0 1 1 0 1 2 1 1 3 1 1\nreactions\nenergy\nsolver\n"
    "error_estimate\n");

inline const std::vector<FamilyInfo> present = [] {
  std::vector<FamilyInfo> list(std::begin(families), std::end(families));
  std::erase_if(list, [](const FamilyInfo& info) {
    const bool of_solids = info.part == Part::solid || info.part == Part::probe_stress || info.part == Part::probe_von_mises ||
                           info.part == Part::probe_stretch || info.part == Part::probe_largest_von_mises;
    const bool of_free = info.part == Part::free_bodies || info.part == Part::turning_bodies || info.part == Part::free_obstacles ||
                         info.part == Part::turning_obstacles || info.part == Part::free_plane_reactions ||
                         info.part == Part::free_pin_reactions;
    return of_free || of_solids || info.part == Part::modulus || info.part == Part::input_boxes || info.part == Part::fixed_boxes;
  });
  return list;
}();

struct Scene {
  SceneFile file;
  softffd::SoftBody body{file.definition};
  Variables variables{file, body.settings};
  softffd::ErrorEstimate estimate{file.definition};

  explicit Scene(const std::string& of = text) : file(parse_scene(of)) {
    variables.apply(body.settings);
    body.initialize(0);
    estimate.initialize(body, 0);
  }
  double get(fmi2ValueReference reference, Type type = Type::Real) {
    double value = NAN;
    variables.get(type, &reference, 1, &value, body, &estimate);
    return value;
  }
  void set(fmi2ValueReference reference, double value, Type type = Type::Real, Phase phase = instantiated) {
    variables.set(phase, type, &reference, 1, &value);
  }
  void rate(fmi2ValueReference reference, int order, double value) { variables.set_input_derivatives(&reference, 1, &order, &value); }
  double output_rate(fmi2ValueReference reference, int order = 1) {
    double value = NAN;
    variables.get_output_derivatives(&reference, 1, &order, &value, body, &estimate);
    return value;
  }
};

/// Number of variables of a family: as many indices as have a name.
inline int count(const Scene& scene, const FamilyInfo& info) {
  int n = 0;
  while (scene.variables.name(reference_of(info.family, n)).find("value reference") != 0) ++n;
  return n;
}

inline bool settable(const FamilyInfo& info) { return info.causality != Causality::output; }

}  // namespace whole_scene
