#include "forces/light_points.hpp"

#include <algorithm>

namespace softffd {

namespace {

/// Squares of how much faster than all others a light point vibrates, and of how much longer steps have to get; mass of a neighbour that
/// pays, in what is moved at most.
constexpr double much_faster = 4, worthwhile = 4, rich = 10;
/// Of the mean mass: no heavier point is light.
constexpr double lightest_share = 0.05;
/// Of what is compared.
constexpr double rounding = 1e-12;

template <class Visit>
void each_spring(const Springs& springs, Visit&& visit) {
  for (const Springs::Row& row : springs.rows())
    for (int lane = 0; lane < row.lanes(); ++lane)
      if (row.stiffness[lane] > 0) visit(row.begin + lane, row.begin + lane + row.offset, row.stiffness[lane]);
}

/// Gives point p so much more mass [kg], if it has neighbours of at least this mass to pay for it. Returns what it got.
double take_from_neighbours(const Springs& springs, const std::vector<bool>& pinned, int p, double more, double least, Scalars& mass) {
  std::vector<int> payers;
  each_spring(springs, [&](int a, int b, double) {
    const int other = a == p ? b : b == p ? a : p;
    if (other != p && !pinned[other] && mass[other] >= least) payers.push_back(other);
  });
  if (payers.empty()) return 0;
  mass[p] += more;
  for (const int payer : payers) mass[payer] -= more / double(payers.size());
  return more;
}

}  // namespace

LightPoints raise_light_points(const Springs& springs, const std::vector<bool>& pinned, double most, double period, Scalars& mass) {
  const int n = int(mass.size());
  most = std::min(most, lightest_share * mass.mean());
  if (!(mass.minCoeff() < most)) return {};
  Scalars stiffness = Scalars::Zero(n);
  each_spring(springs, [&](int p, int q, double k) {
    stiffness[p] += k;
    stiffness[q] += k;
  });
  double fastest = 0;  // of the others, omega^2
  for (int p = 0; p < n; ++p)
    if (!pinned[p] && mass[p] >= most) fastest = std::max(fastest, stiffness[p] / mass[p]);
  std::vector<int> light;
  for (int p = 0; p < n; ++p)
    if (!pinned[p] && mass[p] < most && stiffness[p] > much_faster * fastest * mass[p]) light.push_back(p);
  if (light.empty() || fastest == 0) return {};
  const double share = most / double(light.size());
  const auto raised = [&](int p) { return std::min({share, stiffness[p] / fastest, stiffness[p] * period * period}); };
  double before = 0, after = fastest;  // omega^2
  for (const int p : light) {
    before = std::max(before, stiffness[p] / mass[p]);
    after = std::max(after, stiffness[p] / std::max(mass[p], raised(p)));
  }
  LightPoints found;
  for (const int p : light) {
    const double more = before >= worthwhile * after ? raised(p) - mass[p] : 0;
    if (more > 0) found.moved += take_from_neighbours(springs, pinned, p, more, rich * most, mass);
    if (mass[p] <= std::min(share, stiffness[p] * period * period * (1 + rounding))) found.slight.push_back(p);
  }
  return found;
}

}  // namespace softffd
