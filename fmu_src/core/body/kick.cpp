#include "body/kick.hpp"

namespace softffd {

void KickCoefficients::apply(const Points& spring, const Points& outside, Points& v) const {
  kernels::kick(v.size(), a.data(), b.data(), spring.data(), outside.data(), v.data());
}

void HalfKicks::open(const Points& spring, const Points& external, const Points& v0, const Points& x0, Points& v, Points& x) const {
  kernels::kick_and_drift(v.size(), open_.a.data(), open_.b.data(), spring.data(), external.data(), h_, v0.data(), x0.data(), v.data(),
                          x.data());
}

void HalfKicks::take_masses(const Body& body) { opening_mass_ = closing_mass_ = body.mass; }

void HalfKicks::prepare(const Body& body, double h) {
  if (h == h_ && body.version == version_) return;
  h_ = h;
  version_ = body.version;
  const int n = body.points();
  weak_damping_ = body.damping;
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
    if (strong && !body.pinned[p]) weak_damping_[p] = 0;
  }
  any_strong_ = (weak_damping_ != body.damping).any();
  for (KickCoefficients* each : {&open_, &close_}) each->find_even();
}

}  // namespace softffd
