/// libFuzzer target: any bytes as a resources file. They are either refused with SceneFileError or give a
/// scene that an instance runs on.
///
/// The target writes the first line, checksum included, so that mutations reach the records. A first byte of
/// 0 leaves it to the input.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "instances.hpp"

using namespace softffd::fmi;

namespace {

/// A communication step of few internal steps [s].
double short_step(const SceneFile& scene) {
  double stiffest = std::max({scene.stiffness.edge, scene.stiffness.face, scene.stiffness.body, 1.0});
  const softffd::Vec3& size = scene.definition.lattice.size;
  const double longest = softffd::most_points * size.prod() / (size.minCoeff() * size.minCoeff());  // of stiffness by modulus
  stiffest = std::max(stiffest, longest * scene.modulus.value_or(0));
  for (const softffd::Region& region : scene.definition.regions)
    stiffest = std::max({stiffest, region.stiffness.value_or(0), longest * region.modulus.value_or(0)});
  const auto& mass = scene.definition.mass;
  const double step = std::min(1e-3, std::sqrt(*std::min_element(mass.begin(), mass.end()) / stiffest));
  return scene.step > 0 ? std::min(step, 3 * scene.step) : step;
}

/// Every variable once, through the calls of a host. What an instance refuses is refused by CallError.
void run(SceneFile scene) {
  const double step = short_step(scene);
  const fmi2CallbackFunctions callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
  Instance instance(std::move(scene), Logger(callbacks, "fuzz", true));
  start(instance, 1);
  const fmi2Status stepped = instance.do_step(0, step);
  if (stepped == fmi2OK) instance.load_state(instance.save_state());
  for (const FamilyInfo& info : families)
    for (unsigned index = 0; index < 8; ++index) {
      try {
        value_of(instance, info.family, info.type, int(index));
      } catch (const CallError&) {  // the scene has no such variable
        break;
      }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const bool bare = size > 0 && data[0] == 0;
  try {
    SceneFile scene = parse_scene(bare ? std::string(input.substr(1)) : small_scene::with_first_line(input));
    if (scene.definition.lattice.points() <= 1000) run(std::move(scene));
  } catch (const SceneFileError&) {
  } catch (const CallError&) {
  }
  return 0;
}
