#include "life_cycle.hpp"

#include <algorithm>
#include <cmath>

#include "messages/logger.hpp"

namespace softffd::fmi {

namespace {

/// Means and rates over shorter steps overflow [s].
constexpr double shortest_step = 1e-290;

}  // namespace

void Times::check_step(double time, double step) const {
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * std::max(std::abs(now), std::abs(start));
  const double slack = rounding + std::min(1e-9 * std::max(1.0, now - start), 0.01 * std::abs(step));
  if (!std::isfinite(time) || !(std::abs(time - now) <= slack))
    throw CallError("currentCommunicationPoint: wanted " + number(now) + " s, got " + number(time) + ", " + number(time - now) + " s off");
  if (!std::isfinite(step) || !(step > 0)) throw CallError("communicationStepSize: wanted > 0 s, got " + number(step));
  const double passed = std::max(std::abs(now), now - start);  // the clock of the body starts at 0
  const double spacing = std::nextafter(passed, std::numeric_limits<double>::infinity()) - passed;
  if (const double least = std::max(spacing, shortest_step); step < least)
    throw CallError("communicationStepSize: wanted at least " + number(least) + " s at time " + number(now) +
                    " s, where a shorter step does not advance time, got " + number(step));
  if (now + step > stop + rounding + 1e-9 * std::max(1.0, stop - start))
    throw CallError("a step to " + number(now + step) + " s goes past the stop time " + number(stop) + " s");
}

double Times::horizon(double expected) const { return std::isfinite(stop) && stop > start ? stop - start : expected; }

}  // namespace softffd::fmi
