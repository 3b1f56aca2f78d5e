/// Saving and restoring an instance: the part of Instance that knows what a state consists of.
#include <algorithm>
#include <iterator>

#include "instance.hpp"
#include "methods/traits.hpp"

namespace softffd::fmi {

namespace {

/// What of the settings had taken effect; values set since then may still wait for the next step.
struct InEffect {
  double mass, edge, face, body, damping;
  Vec3 gravity;
};

template <class Archive>
void pass(Archive& archive, InEffect& s) {
  for (double* value : {&s.mass, &s.edge, &s.face, &s.body, &s.damping}) archive.number(*value);
  archive.numbers(s.gravity.data(), 3);
}

struct Place {
  Count phase, changed, material_changed, rated;
  double start_time, time, stop_time;
};

template <class Archive>
void pass(Archive& archive, Place& place) {
  for (Count* value : {&place.phase, &place.changed, &place.material_changed, &place.rated}) archive.integer(*value);
  for (double* value : {&place.start_time, &place.time, &place.stop_time}) archive.number(*value);
}

template <class Archive, class Values>
void pass_values(Archive& archive, Values& values) {
  for (auto& list : values) archive.numbers(list.data(), list.size());
}

bool sound(const InEffect& s) {
  const auto weight = [](double value) { return std::isfinite(value) && value >= 0; };
  return weight(s.mass) && s.mass > 0 && weight(s.edge) && weight(s.face) && weight(s.body) && weight(s.damping) && s.gravity.allFinite();
}

/// Whether all values are such as the setters take.
template <class Values>
bool in_range(const Values& values) {
  return std::all_of(std::begin(families), std::end(families), [&](const FamilyInfo& info) {
    const auto& list = values[std::size_t(info.family)];
    return std::all_of(list.begin(), list.end(), [&](double v) { return std::isfinite(v) && v >= info.min && v > info.above; });
  });
}

bool sound(const Place& place) {
  const Count phase = place.phase;
  const bool known =
      phase == instantiated || phase == initializing || phase == stepping || phase == step_failed || phase == terminated || phase == failed;
  const auto flag = [](Count value) { return value == 0 || value == 1; };
  return known && flag(place.changed) && flag(place.material_changed) && flag(place.rated) && std::isfinite(place.time) &&
         std::isfinite(place.start_time);
}

bool counter(Count value) { return value >= 0 && value <= Count{1} << 53; }

/// Whether all methods that the course names can run on this lattice.
bool possible(const Course& course, const Lattice& lattice) {
  return LayerMatrix::fits(lattice) || !(needs_matrices(course.method) || needs_matrices(course.favourite));
}

bool sound(const Course& course) {
  return counter(course.clock.count) && course.clock.parts > 0 && course.clock.parts <= Propagator::most_steps && counter(course.steps) &&
         counter(course.rejected) && counter(course.factored.uses);
}

bool sound(const Progress& progress) {
  return sound(progress.course) && progress.watch.share > 0 && progress.watch.share <= 1 && progress.motion.x.allFinite() &&
         progress.motion.v.allFinite() && progress.exchange_time > 0 && counter(progress.contacts_resolved) &&
         counter(progress.exchange.contacts_resolved) && std::all_of(progress.contacts.begin(), progress.contacts.end(), counter);
}

}  // namespace

Bytes Instance::save_state() {
  Bytes bytes;
  StateWriter writer(bytes);
  const bool waits = body_.material_waits();  // since a step that was discarded
  Place place{phase, changed_ || waits, material_changed_ || waits, rated_, start_time_, time_, stop_time_};
  const Material& material = body_.material();
  const Stiffness& springs = material.stiffness;
  InEffect in_effect{material.mass, springs.edge, springs.face, springs.body, material.damping, body_.settings.gravity};
  Progress progress = body_.progress();
  pass(writer, place);
  pass_values(writer, values_);
  for (auto& order : rates_) pass_values(writer, order);
  pass(writer, in_effect);
  pass(writer, progress);
  if (error_estimate_) {
    ErrorEstimate::Memory memory = error_estimate_->memory();
    pass(writer, memory);
  }
  return bytes;
}

void Instance::load_state(const Bytes& bytes) {
  StateReader reader(bytes);
  Place place{};
  InEffect in_effect{};
  auto values = values_;
  auto rates = rates_;
  Progress progress = body_.progress();
  pass(reader, place);
  pass_values(reader, values);
  for (auto& order : rates) pass_values(reader, order);
  pass(reader, in_effect);
  pass(reader, progress);
  std::optional<ErrorEstimate::Memory> memory;
  if (error_estimate_) pass(reader, memory.emplace(error_estimate_->memory()));
  if (!reader.at_end()) throw StateError("the state is too long");
  const double method = values[std::size_t(Family::solver_method)][0];
  if (!sound(place) || !sound(in_effect) || !sound(progress) || (memory && !(sound(memory->shadow) && counter(memory->tally.steps))) ||
      !in_range(values) || !(method >= 1 && method <= method_count) || !available(method) || !possible(progress.course, body_.lattice()) ||
      (memory && !possible(memory->shadow.course, body_.lattice())))
    throw StateError("the state holds values that no run gives");

  values_ = std::move(values);
  rates_ = std::move(rates);
  rated_ = place.rated;
  phase = Phase(place.phase);
  start_time_ = place.start_time;
  time_ = place.time;
  stop_time_ = place.stop_time;
  apply_values();
  Settings& s = body_.settings;
  s.mass = in_effect.mass;
  s.stiffness = {in_effect.edge, in_effect.face, in_effect.body};
  s.damping = in_effect.damping;
  s.gravity = in_effect.gravity;
  body_.restore(progress, 0);
  if (memory) error_estimate_->restore(*memory, s, 0);
  changed_ = place.changed;
  material_changed_ = place.material_changed;
}

}  // namespace softffd::fmi
