/// A row of contact: a sample of the surface at a plane.
#pragma once
#include <compare>

namespace softffd {

struct SurfaceRow {
  int plane, sample;
  auto operator<=>(const SurfaceRow&) const = default;
};

}  // namespace softffd
