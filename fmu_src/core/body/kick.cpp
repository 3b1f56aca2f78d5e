#include "body/kick.hpp"

namespace softffd {

void KickCoefficients::apply(const Points& spring, const Points& outside, Points& v, Team* team) const {
  in_parts(team, v.size(), [&](std::ptrdiff_t i, std::ptrdiff_t end) {
    kernels::kick(end - i, a.data() + i, b.data() + i, spring.data() + i, outside.data() + i, v.data() + i);
  });
}

void HalfKicks::open(const Points& spring, const Points& external, const Points& v0, const Points& x0, Points& v, Points& x) const {
  in_parts(team_, v.size(), [&](std::ptrdiff_t i, std::ptrdiff_t end) {
    kernels::kick_and_drift(end - i, open_.a.data() + i, open_.b.data() + i, spring.data() + i, external.data() + i, h_, v0.data() + i,
                            x0.data() + i, v.data() + i, x.data() + i);
  });
}

void HalfKicks::prepare(const Body& body, double h) {
  team_ = body.springs.team();
  if (h == h_ && body.version == version_) return;
  h_ = h;
  version_ = body.version;
  const int n = body.points();
  if (body.springs.dashpots()) {
    opening_mass_ = closing_mass_ = body.mass;
    return;
  }
  for (int p = 0; p < n; ++p) {
    const double m = body.mass[p], d = body.damping[p], half = 0.5 * h, g = d * half / m;
    const bool strong = g > 1;
    const double e = 1 / (1 + g + 0.5 * g * g);
    const double strong_b = strong ? (1 - e) / d : 0;
    for (int i = p; i < 3 * n; i += n) {
      open_.a[i] = strong ? e : 1 - g;
      open_.b[i] = strong ? strong_b : half / m;
      close_.a[i] = strong ? e : 1 / (1 + g);
      close_.b[i] = strong ? strong_b : half / m / (1 + g);
    }
    opening_mass_[p] = half / open_.b[p];
    closing_mass_[p] = half / close_.b[p];
  }
  for (KickCoefficients* each : {&open_, &close_}) each->find_even();
}

}  // namespace softffd
