/// Saves and restores an instance: the part of Instance that defines the data of a state.
#include <algorithm>
#include <iterator>

#include "instance/instance.hpp"

namespace softffd::fmi {

/// Settings that have taken effect. Values set since then may still wait for the next step.
struct InEffect {
  double mass, edge, face, body, modulus, poissons_ratio, damping, internal_damping;
  Vec3 gravity;
};

template <class Archive>
void pass(Archive& archive, InEffect& s) {
  for (double* value : {&s.mass, &s.edge, &s.face, &s.body, &s.modulus, &s.poissons_ratio, &s.damping, &s.internal_damping})
    archive.number(*value);
  archive.numbers(s.gravity.data(), 3);
}

struct Place {
  Count phase, changed, material_changed, rated;
  Times times;
};

template <class Archive>
void pass(Archive& archive, Place& place) {
  for (Count* value : {&place.phase, &place.changed, &place.material_changed, &place.rated}) archive.integer(*value);
  for (double* value : {&place.times.start, &place.times.now, &place.times.stop, &place.times.tolerance}) archive.number(*value);
  archive.choice(place.times.given, true);
}

template <class Archive>
void pass(Archive& archive, Variables::Values& values) {
  for (auto& list : values.numbers) archive.numbers(list.data(), list.size());
  for (auto& order : values.rates)
    for (auto& list : order) archive.numbers(list.data(), list.size());
}

template <class Archive>
void pass(Archive& archive, Variables::LastStep& last) {
  archive.number(last.length);
  for (auto& list : last.before) archive.numbers(list.data(), list.size());
}

struct Whole {
  Place place;
  Variables::Values values;
  Variables::LastStep last_step;
  InEffect in_effect;
  Run run;
  std::optional<ErrorEstimate::Memory> memory;
};

template <class Archive>
void pass(Archive& archive, Whole& whole) {
  pass(archive, whole.place);
  pass(archive, whole.values);
  pass(archive, whole.last_step);
  pass(archive, whole.in_effect);
  pass(archive, whole.run);
  if (whole.memory) pass(archive, *whole.memory);
}

namespace {

/// Largest deviation from 1 of the squared norm of a unit quaternion.
constexpr double of_a_unit = 1e-6;

bool sound(const InEffect& s) {
  const auto weight = [](double value) { return std::isfinite(value) && value >= 0; };
  return weight(s.mass) && s.mass > 0 && weight(s.edge) && weight(s.face) && weight(s.body) && weight(s.modulus) &&
         weight(s.poissons_ratio) && s.poissons_ratio < 0.5 && weight(s.damping) && weight(s.internal_damping) && s.gravity.allFinite();
}

bool sound(const Place& place) {
  const Count phase = place.phase;
  const bool known =
      phase == instantiated || phase == initializing || phase == stepping || phase == step_failed || phase == terminated || phase == failed;
  const auto flag = [](Count value) { return value == 0 || value == 1; };
  return known && flag(place.changed) && flag(place.material_changed) && flag(place.rated) && std::isfinite(place.times.now) &&
         std::isfinite(place.times.start) && std::isfinite(place.times.tolerance) && place.times.tolerance >= 0;
}

bool sound(const Variables::LastStep& last) { return std::isfinite(last.length) && last.length >= 0; }

bool counter(Count value) { return value >= 0 && value <= Count{1} << 53; }

/// Checks counters that are doubled in the course of a run: they must be small.
bool sound(const StiffContact& stiff) {
  const auto small = [](Count value) { return value >= 0 && value <= Count{1} << 20; };
  return stiff.doubts >= 0 && stiff.doubts <= thresholds::most_doubts && small(stiff.looks) && small(stiff.trust) &&
         small(stiff.next_trust) && small(stiff.rest_trust) && small(stiff.next_rest_trust);
}

bool sound(const ContactSteps& steps) {
  return counter(steps.free) && counter(steps.free_next) && counter(steps.impact) && counter(steps.impact_next) && counter(steps.seen);
}

bool sound(const FreeState& free) {
  const double size = Eigen::Map<const Eigen::Vector4d>(free.orientation.data()).squaredNorm();
  return std::isfinite(free.time) && free.position.allFinite() && free.velocity.allFinite() && free.momentum.allFinite() &&
         std::abs(size - 1) < of_a_unit;
}

bool sound(const Run& run) {
  const Clock& clock = run.physical.clock;
  return sound(run.physical.stiff) && sound(run.control.contact) && counter(clock.count) && clock.parts > 0 && counter(clock.parts) &&
         counter(run.physical.steps) && counter(run.control.rejected) && counter(run.control.factored.uses) &&
         run.energy.step_factor >= thresholds::least_step_factor && run.energy.step_factor <= 1 && run.physical.motion.x.allFinite() &&
         run.physical.motion.v.allFinite() && run.hidden >= 0 && std::isfinite(run.hidden) && run.pin_time >= 0 &&
         std::isfinite(run.pin_time) && counter(run.contacts_resolved) && counter(run.physical.exchange.contacts_resolved) &&
         std::all_of(run.contacts.begin(), run.contacts.end(), counter) &&
         std::ranges::all_of(run.physical.motion.free, [](const FreeState& free) { return sound(free); });
}

bool sound(const Whole& whole, const Variables& variables) {
  const auto& memory = whole.memory;
  return sound(whole.place) && sound(whole.last_step) && sound(whole.in_effect) && sound(whole.run) &&
         (!memory || (sound(memory->shadow) && counter(memory->tally.steps))) && variables.sound(whole.values);
}

}  // namespace

/// Returns the present data. Every state of the scene has arrays of the same sizes.
Whole Instance::whole() const {
  const bool waits = body_.material_waits();  // since a discarded step
  const Variables::Values& values = variables_.values();
  const Material& material = body_.material();
  const Stiffness& springs = material.stiffness;
  return {.place = {phase, values.changed || waits, values.material_changed || waits, values.rated, times_},
          .values = values,
          .last_step = variables_.last_step(),
          .in_effect = {material.mass, springs.edge, springs.face, springs.body, material.modulus, material.poissons_ratio,
                        material.damping, material.internal_damping, body_.settings.gravity},
          .run = body_.run(),
          .memory = error_estimate_ ? std::optional(error_estimate_->memory()) : std::nullopt};
}

Bytes Instance::save_state() const {
  Whole all = whole();
  StateSize size;
  pass(size, all);
  Bytes bytes;
  bytes.reserve(size.bytes);
  StateWriter writer(bytes);
  pass(writer, all);
  return bytes;
}

void Instance::load_state(const Bytes& bytes) {
  StateReader reader(bytes);
  Whole all = whole();
  pass(reader, all);
  if (!reader.at_end()) throw StateError("the state is too long");
  all.values.rated = all.place.rated;
  if (!sound(all, variables_)) throw StateError("the state has values that no run produces");
  const Place& place = all.place;
  phase = Phase(place.phase);
  times_ = place.times;
  variables_.restore(std::move(all.values), std::move(all.last_step));
  apply_values();
  Settings& s = body_.settings;
  const InEffect& before = all.in_effect;
  s.mass = before.mass;
  s.stiffness = {before.edge, before.face, before.body};
  s.modulus = before.modulus;
  s.poissons_ratio = before.poissons_ratio;
  s.damping = before.damping;
  s.internal_damping = before.internal_damping;
  s.gravity = before.gravity;
  body_.restore(all.run, 0);
  if (all.memory) error_estimate_->restore(*all.memory, s, 0);
  variables_.set_changed(place.changed, place.material_changed);
}

}  // namespace softffd::fmi
