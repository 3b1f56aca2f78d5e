/// Numbers without a pattern, the same on every machine.
#pragma once
#include <cstdint>

#include "model/types.hpp"

namespace softffd {

class Random {
 public:
  /// Evenly between two numbers (Knuth's linear congruential generator, upper bits).
  double operator()(double low, double high) {
    state_ = 6364136223846793005u * state_ + 1442695040888963407u;
    return low + (high - low) * double(state_ >> 11) / 9007199254740992.0;
  }
  Vec3 vector(double size) {
    const double x = (*this)(-size, size), y = (*this)(-size, size);
    return {x, y, (*this)(-size, size)};
  }
  /// A unit vector, evenly over the sphere.
  Vec3 direction() {
    for (;;) {
      const Vec3 v = vector(1);
      if (const double size = v.norm(); size > 0.1 && size < 1) return v / size;
    }
  }

 private:
  std::uint64_t state_ = 20090417;
};

}  // namespace softffd
