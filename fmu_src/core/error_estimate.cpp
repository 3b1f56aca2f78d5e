#include "error_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "traits.hpp"

namespace softffd {

namespace {

/// By which ten times the tolerance multiplies the error of a method with error control, by measurement.
constexpr double looser = 6;

}  // namespace

ErrorEstimate::ErrorEstimate(const Definition& definition) : shadow_(definition) {}

void ErrorEstimate::take_settings(const Settings& settings) {
  const Settings& old = shadow_.settings;
  const bool same = old.mass == settings.mass && old.damping == settings.damping && old.stiffness.edge == settings.stiffness.edge &&
                    old.stiffness.face == settings.stiffness.face && old.stiffness.body == settings.stiffness.body;
  shadow_.settings = settings;
  if (!same) shadow_.settings_changed();
}

void ErrorEstimate::initialize(const SoftBody& body, double t0) {
  take_settings(body.settings);
  time_ = ratio_time_ = value_ = 0;
  lost_ = shadow_.initialize(t0) != StepStatus::ok;
}

/// Sets the shadow's steps for a communication step; returns r^p.
double ErrorEstimate::choose_steps(const SoftBody& body, double H) {
  Settings& settings = shadow_.settings;
  const Method method = settings.method = body.method();
  const Traits t = traits(method);
  const double h = body.internal_step(), steps = std::max(1.0, std::round(H / h));
  const bool by_tolerance = t.error_control() && settings.step == 0 && steps > 2 && h < 0.5 * t.automatic * shadow_.stable_step();
  if (by_tolerance) {
    settings.tolerance *= 10;
    return looser;
  }
  settings.step = H / std::ceil(1.5 * steps);
  return power(settings.step / h, t.order);
}

void ErrorEstimate::follow(const SoftBody& body, double H) {
  if (lost_) return;
  take_settings(body.settings);
  const bool given = body.settings.step > 0;
  const double ratio = choose_steps(body, H);
  lost_ = shadow_.advance(H) != StepStatus::ok;
  if (lost_) {
    value_ = body.lattice().largest_side();
    return;
  }
  time_ += H;
  ratio_time_ += H * std::abs(ratio - 1);
  double difference = 0;
  const Points &x = body.state().x, &y = shadow_.state().x;
  for (int i = 0; i < x.size(); ++i) difference = std::max(difference, std::abs(x.data()[i] - y.data()[i]));
  const double estimate = difference * time_ / ratio_time_;
  const bool free = given && !body.damped();
  value_ = free && out_of_phase() ? std::max(value_, estimate) : estimate;
  if (free) value_ = std::max(value_, lost_vibration(body));
}

/// Has the estimate ever said that vibrations are about as wrong as they are large?
bool ErrorEstimate::out_of_phase() const {
  return value_ > 0.1 * shadow_.amplitude(shadow_.largest_energy(), std::numeric_limits<double>::infinity());
}

/// Size of the vibrations that steps too long for them have taken away. A method with error control damps what it does not resolve, and
/// both runs alike, so that they agree; what they should have more of is energy. Losses of motions that the steps do resolve are much
/// smaller in the shadow.
double ErrorEstimate::lost_vibration(const SoftBody& body) const {
  if (!traits(body.method()).error_control()) return 0;
  const double lost = shadow_.lost_energy(), rounding = 1e-10 * shadow_.largest_energy();
  return lost > rounding && lost > 0.5 * body.lost_energy() ? shadow_.amplitude(lost, shadow_.internal_step()) : 0;
}

void ErrorEstimate::restore(const Memory& memory, const Settings& settings, double start_time) {
  shadow_.settings = settings;
  shadow_.restore(memory.shadow, start_time);
  time_ = memory.time;
  ratio_time_ = memory.ratio_time;
  value_ = memory.value;
  lost_ = memory.lost;
}

}  // namespace softffd
