#include "forces/kick.hpp"

namespace softffd {

HalfKicks::HalfKicks(int points) {
  for (Coefficients* c : {&open_, &close_}) c->a = c->b = Scalars::Zero(3 * points);
}

void HalfKicks::prepare(const Body& body, double h) {
  if (h == h_ && body.version == version_) return;
  h_ = h;
  version_ = body.version;
  damped_ = body.damped;
  const int n = body.points();
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
  }
}

void HalfKicks::apply(const Coefficients& c, const Points& spring, const Points& external, Points& v) const {
  const std::size_t n = v.size();
  if (damped_)
    kernels::kick(n, c.a.data(), c.b.data(), spring.data(), external.data(), v.data());
  else
    kernels::kick_undamped(n, c.b.data(), spring.data(), external.data(), v.data());
}

}  // namespace softffd
