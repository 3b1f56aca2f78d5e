#include "estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/implicit/implicit_contact.hpp"
#include "machine/elementary.hpp"
#include "methods/ros34pw2.hpp"
#include "methods/traits.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace {

/// Size of the shadow's steps relative to the run's [1].
constexpr double finer = 2.0 / 3;

/// True if a stiff body was beside an obstacle in the last communication step, or a damped one beside an obstacle or pinned: the shadow
/// then follows the same rules.
bool of_impacts(const SoftBody& body) {
  const Reason reason = body.readings().reason();
  const bool damped = reason == Reason::damped_contact || reason == Reason::damped_motion ||
                      (body.settings.method == Method::sdirk2 && body.settings.step == 0);
  return damped || reason == Reason::impact || reason == Reason::ringing_flight || reason == Reason::stiff_contact;
}

/// Returns the definition without sensors, because those of the shadow are not read.
Definition without_sensors(Definition definition) {
  definition.sensed = {};
  return definition;
}

/// Returns the fraction of a vibration's amplitude that a step of this phase angle keeps [1]; angle: [rad].
double kept_by(Method method, double angle) {
  if (method == Method::backward_euler) return 1 / hypotenuse(1, angle);
  return method == Method::sdirk2 ? ImplicitContact::kept(angle) : Ros34pw2::kept(angle);
}

}  // namespace

ErrorEstimate::ErrorEstimate(const Definition& definition)
    : shadow_(without_sensors(definition)), change_(Points::Zero(definition.lattice.points(), 3)), force_(change_) {
  tally_.slopes = change_;
}

void ErrorEstimate::initialize(const SoftBody& body, double t0) {
  shadow_.settings = body.settings;
  tally_ = {.vibration = {}, .slopes = tally_.slopes};
  tally_.slopes.setZero();
  tally_.lost = shadow_.initialize(t0) != StepStatus::ok;
}

/// Sets the shadow's steps for a communication step; returns r^p.
double ErrorEstimate::choose_steps(const SoftBody& body, double H, Count taken) {
  Settings& settings = shadow_.settings;
  const Readings run = body.readings();
  if (of_impacts(body)) {
    settings.step_factor = finer;
    return power(finer, 2);
  }
  settings.method = run.method();
  const Traits t = traits(settings.method);
  const double h = run.internal_step(), steps = std::max(1.0, std::round(H / h));
  const bool equal = std::abs(double(taken) - steps) <= 0.05 * steps;
  if (settings.step == 0 && taken > 2 && (t.error_control() || !equal)) {
    settings.step_factor = finer;
    return power(finer, t.order);
  }
  settings.step = H / std::ceil(steps / finer);
  return power(settings.step / h, t.order);
}

void ErrorEstimate::follow(const SoftBody& body, double H) {
  if (tally_.lost) return;
  shadow_.settings = body.settings;
  const bool given = body.settings.step > 0;
  const Count taken = std::max(Count{1}, body.readings().steps() - tally_.steps);
  tally_.steps = body.readings().steps();
  const double ratio = choose_steps(body, H, taken);
  tally_.lost = shadow_.advance(H) != StepStatus::ok;
  if (tally_.lost) {
    tally_.value = body.lattice().largest_side();
    return;
  }
  tally_.time += H;
  tally_.ratio_time += H * std::abs(ratio - 1);
  double difference = 0;
  const Points &x = body.state().x, &y = shadow_.state().x;
  for (int i = 0; i < x.size(); ++i) difference = std::max(difference, std::abs(x.data()[i] - y.data()[i]));
  if (!of_impacts(body)) follow_vibration(body, H, taken);
  const double estimate =
      std::max({difference * tally_.time / tally_.ratio_time, tally_.damped_away,
                body.run().physical.error.largest() + body.run().physical.damped_error + body.run().physical.damped_fading});
  const bool free = given && !body.readings().damped();
  tally_.value = free && out_of_phase() ? std::max(tally_.value, estimate) : estimate;
  if (free) tally_.value = std::max(tally_.value, lost_vibration(body));
}

/// True if the last estimate is above a tenth of the largest vibrations so far, which then count as about as wrong as they are large.
bool ErrorEstimate::out_of_phase() const {
  const Readings shadow = shadow_.readings();
  return tally_.value > 0.1 * shadow.amplitude(shadow.largest_energy(), std::numeric_limits<double>::infinity());
}

/// Returns the size of the vibrations that too long steps have damped away [m]. A method with error control damps what it does not
/// resolve, in both runs alike, so that the runs agree, but both then have too little energy. Losses of motions that the steps do resolve
/// are much smaller in the shadow.
double ErrorEstimate::lost_vibration(const SoftBody& body) const {
  if (!traits(body.readings().method()).error_control()) return 0;
  const Readings shadow = shadow_.readings();
  const double lost = shadow.lost_energy(), rounding = 1e-10 * shadow.largest_energy();
  return lost > rounding && lost > 0.5 * body.readings().lost_energy() ? shadow.amplitude(lost, shadow.internal_step()) : 0;
}

/// Returns the fraction of the change of the forces' slopes, from before this communication step to its end, that came at once. If the
/// slopes have not changed, only a pin can excite vibrations: the result is 1 with pins, else 0.
double ErrorEstimate::follow_slopes(double H) {
  const Settings& settings = shadow_.settings;
  const Points &rate = *settings.force_rate, &second = *settings.force_bend[0], &third = *settings.force_bend[1];
  double kink = 0, bend = 0;
  for (int i = 0; i < tally_.slopes.size(); ++i) {
    const double change = H * (second(i) + H * third(i) / 2);
    kink = std::max(kink, std::abs(rate(i) - tally_.slopes(i)));
    bend = std::max(bend, std::abs(change));
    tally_.slopes(i) = rate(i) + change;
  }
  return kink + bend > 0 ? kink / (kink + bend) : settings.pins.empty() ? 0 : 1;
}

/// Follows the largest vibration. Run and shadow lose what implicit steps damp away; in the body itself the vibration lasts longer.
void ErrorEstimate::follow_vibration(const SoftBody& body, double H, Count taken) {
  const double kept = shadow_.readings().remaining(H, tally_.vibration.frequency), kink = follow_slopes(H);
  tally_.vibration.amplitude *= kept;
  tally_.damped_away *= kept;
  if (!passes_over_vibrations(body.readings().method())) return;
  const Vibration vibration = shadow_.readings().set_off(kink, change_, force_);
  const double remains = shadow_.readings().remaining(H, vibration.frequency);
  if (vibration.amplitude * remains > tally_.vibration.amplitude) {
    tally_.vibration = {vibration.amplitude * remains, vibration.frequency};
    tally_.kept = 1;
  }
  const double angle = tally_.vibration.frequency * H / double(taken);
  tally_.kept *= power(kept_by(body.readings().method(), angle), int(taken));
  tally_.damped_away = std::max(tally_.damped_away, tally_.vibration.amplitude * (1 - tally_.kept));
}

void ErrorEstimate::restore(const Memory& memory, const Settings& settings, double start_time) {
  shadow_.settings = settings;
  shadow_.restore(memory.shadow, start_time);
  tally_ = memory.tally;
}

}  // namespace softffd
