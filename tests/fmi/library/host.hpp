/// Components as a host has them, by the functions of FMI 2.0, and scenes for them.
#pragma once
#include <cstdlib>
#include <string>
#include <vector>

extern "C" {
#include "fmi2Functions.h"
}

#include "check.hpp"
#include "small_scene.hpp"
#include "variable_table.hpp"

namespace component {

using softffd::fmi::Family;

/// Writes a scene and returns the URI of its folder.
inline std::string resources(const std::string& parts, bool stiff = false, const std::string& spin = "0 0 0") {
  return (stiff ? small_scene::Box{.stiffness = 1e8, .initial = "1 1 1 0 0 0.001 0 0 0 " + spin} : small_scene::Box{}).resources(parts);
}

inline const std::string damped = "damping 0.05\n", heavy = "gravity 0 0 -9.81\n", watched = "energy\nsolver\nreactions\n";
inline const std::string planes = "plane ground fixed 0 0 0 0.1 0 1 0 0 0 0 0 0 0.4\nplane wall input 1.02 0 0 -1 0 0 0 0 0 0 0.1 0 0.2\n";
inline const std::string corner = "plane side fixed 0 -0.01 0 0 1 0 0 0 0 0 0 0 0.3\n";
inline const std::string pins = "pin base fixed 0 1\npin hand input 26\n";
inline const std::string driven = "load push 18 19 20\nforces 13 14\n";
inline const std::string regions = "region_stiffness 4000 0 1 2\nregion_damping 0.2 3 4\nprobe tip 0.5 0.5 0.9\nvelocities 0 13\n";
inline const std::string everything = damped + heavy + planes + pins + driven + regions + watched;

inline fmi2ValueReference reference(Family family, unsigned index = 0) { return unsigned(family) << 24 | index; }

inline void silent(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...) {}
inline constexpr fmi2CallbackFunctions quiet_callbacks{silent, std::calloc, std::free, nullptr, nullptr};

inline fmi2Component instantiate(const std::string& uri, fmi2Boolean logging = fmi2False, const char* guid = "{g}",
                                 const fmi2CallbackFunctions& callbacks = quiet_callbacks, const char* name = "box") {
  return fmi2Instantiate(name, fmi2CoSimulation, guid, uri.c_str(), &callbacks, fmi2False, logging);
}

/// Up to the first step.
inline fmi2Status begin(fmi2Component c) {
  if (fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0) != fmi2OK || fmi2EnterInitializationMode(c) != fmi2OK) return fmi2Error;
  return fmi2ExitInitializationMode(c);
}

inline fmi2Component started(const std::string& uri, int method = 1, fmi2Boolean logging = fmi2False) {
  fmi2Component c = instantiate(uri, logging);
  const fmi2ValueReference solver = reference(Family::solver_method);
  CHECK(fmi2SetInteger(c, &solver, 1, &method) == fmi2OK);
  CHECK(begin(c) == fmi2OK);
  return c;
}

inline fmi2Status set(fmi2Component c, Family family, unsigned index, double value) {
  const fmi2ValueReference wanted = reference(family, index);
  return fmi2SetReal(c, &wanted, 1, &value);
}

inline fmi2Status step(fmi2Component c, int n) { return fmi2DoStep(c, n * 0.01, 0.01, fmi2True); }

/// Of so many control points.
inline std::vector<double> positions(fmi2Component c, unsigned points = 27) {
  std::vector<fmi2ValueReference> references(3 * points);
  for (unsigned i = 0; i < 3 * points; ++i) references[i] = reference(Family::position, i);
  std::vector<double> values(3 * points);
  CHECK(fmi2GetReal(c, references.data(), references.size(), values.data()) == fmi2OK);
  return values;
}

}  // namespace component
