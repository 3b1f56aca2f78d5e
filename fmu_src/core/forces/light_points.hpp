/// Points so light that they alone make explicit steps short, and whose own motion does not matter to the body's: they are made heavier, at
/// the cost of their neighbours.
#pragma once
#include "forces/springs.hpp"

namespace softffd {

struct LightPoints {
  double moved = 0;           ///< mass that they were given [kg]: the others' positions err by about its share of the whole, in boxes
  std::vector<int> slight{};  ///< those that are within both bounds: what they swing by on their own does not matter, nor its phase
};

/// Raises the masses of points below `most` [kg] that vibrate more than twice as fast as all others, until they do not, by `most` in all,
/// and each while it still takes no more than `period` [s] to swing by a radian: what it vibrates by after an impact of speed v is v times
/// that. Only where it pays, by steps of more than twice the length. Neighbours by a spring pay in equal parts, so that the whole keeps its
/// mass; pinned points neither get nor pay.
LightPoints raise_light_points(const Springs& springs, const std::vector<bool>& pinned, double most, double period, Scalars& mass);

}  // namespace softffd
