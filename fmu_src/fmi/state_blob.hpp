/// An FMU state as bytes: flat, no pointers, little-endian, no padding.
///
/// In memory it is the payload alone; serialized it has a head of 40 bytes: magic, format version, hash of the scene's guid, payload size,
/// FNV-1a checksum of the payload. The same bits come back in another instance or process of the same scene; anything else is refused.
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "estimate.hpp"

namespace softffd::fmi {

using Bytes = std::vector<unsigned char>;

/// A blob that is no state of this scene; what() says why.
struct StateError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

Bytes with_head(const std::string& guid, const Bytes& payload);
/// The payload of a serialized state. Throws StateError.
Bytes without_head(const std::string& guid, std::span<const unsigned char> serialized);
constexpr std::size_t head_size = 40;

inline std::uint64_t little_endian(std::uint64_t word) {
  if constexpr (std::endian::native == std::endian::little) return word;
  std::uint64_t turned = 0;
  for (int i = 0; i < 8; ++i) turned |= (word >> 8 * i & 0xff) << 8 * (7 - i);
  return turned;
}

/// Appends values, eight bytes each.
class StateWriter {
 public:
  explicit StateWriter(Bytes& bytes) : bytes_(bytes) {}
  void number(double& value) { word(std::bit_cast<std::uint64_t>(value)); }
  void integer(Count& value) { word(std::uint64_t(value)); }
  template <class Choice>
  void choice(Choice& value, Choice) {
    word(std::uint64_t(value));
  }
  void numbers(double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) number(values[i]);
  }

 private:
  void word(std::uint64_t value) {
    const std::uint64_t stored = little_endian(value);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + 8);
    std::memcpy(bytes_.data() + at, &stored, 8);
  }
  Bytes& bytes_;
};

/// Takes values in the same order. Throws StateError at the end of the bytes, for numbers that are no numbers and choices that there are
/// not.
class StateReader {
 public:
  explicit StateReader(std::span<const unsigned char> bytes) : rest_(bytes) {}
  void number(double& value) {
    value = std::bit_cast<double>(word());
    if (value != value) throw StateError("a value of the state is not a number");
  }
  void integer(Count& value) { value = Count(word()); }
  /// One of an enumeration's values up to `last`, or a flag.
  template <class Choice>
  void choice(Choice& value, Choice last) {
    const std::uint64_t number = word();
    if (number > std::uint64_t(last)) throw StateError("a value of the state is none of those that it may have");
    value = Choice(number);
  }
  void numbers(double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) number(values[i]);
  }
  bool at_end() const { return rest_.empty(); }

 private:
  std::uint64_t word() {
    if (rest_.size() < 8) throw StateError("the state is too short");
    std::uint64_t stored = 0;
    std::memcpy(&stored, rest_.data(), 8);
    rest_ = rest_.subspan(8);
    return little_endian(stored);
  }
  std::span<const unsigned char> rest_;
};

/// Passes every value of a Course to a StateWriter or StateReader, in one order for both.
template <class Archive>
void pass(Archive& archive, Course& course) {
  for (double* value : {&course.clock.origin, &course.clock.h,      &course.clock.unit,    &course.bound,
                        &course.leapfrog.h,   &course.leapfrog.due, &course.leapfrog.soon, &course.leapfrog.window,
                        &course.bm4.h,        &course.bm4.due,      &course.bm4.soon,      &course.bm4.window,
                        &course.rkn12,        &course.dop853,       &course.ros34pw2,      &course.floating_frame,
                        &course.factored.h,   &course.work,         &course.race_due,      &course.race_soon,
                        &course.race_window,  &course.usual,        &course.race_pause,    &course.forecast,
                        &course.contact.h})
    archive.number(*value);
  for (Count* value : {&course.clock.count, &course.clock.parts, &course.factored.uses, &course.steps, &course.rejected, &course.factors,
                       &course.contact.free, &course.contact.free_next, &course.contact.impact, &course.contact.impact_next})
    archive.integer(*value);
  for (Method* value : {&course.method, &course.favourite}) archive.choice(*value, Method::floating_frame);
  for (Reason* value : {&course.reason, &course.favourite_reason}) archive.choice(*value, Reason::free_flight);
  archive.choice(course.factored.in_frame, true);
  for (Points* points : {&course.bound_x, &course.factored.x}) archive.numbers(points->data(), points->size());
}

/// The same for a Progress.
template <class Archive>
void pass(Archive& archive, Progress& progress) {
  State& motion = progress.motion;
  for (double* value : {&motion.time, &motion.previous_h, &progress.exchange_time, &progress.dissipated, &progress.work,
                        &progress.potential, &progress.exchange.dissipated, &progress.exchange.work})
    archive.number(*value);
  EnergyWatch& watch = progress.watch;
  for (double* value :
       {&watch.kinetic_elastic, &watch.forces, &watch.received, &watch.gained, &watch.balance, &watch.largest, &watch.due, &watch.share})
    archive.number(*value);
  archive.choice(watch.hopeless, true);
  for (Count* value : {&progress.contacts_resolved, &progress.exchange.contacts_resolved}) archive.integer(*value);
  for (Points* points : {&motion.x, &motion.v, &motion.spring, &motion.previous, &progress.outside})
    archive.numbers(points->data(), points->size());
  for (auto* impulses : {&progress.exchange.planes, &progress.exchange.pins})
    for (Impulse& impulse : *impulses) {
      archive.numbers(impulse.force.data(), 3);
      archive.numbers(impulse.torque.data(), 3);
    }
  for (Count& count : progress.contacts) archive.integer(count);
  pass(archive, progress.course);
}

/// The same for the memory of an error estimate.
template <class Archive>
void pass(Archive& archive, ErrorEstimate::Memory& memory) {
  pass(archive, memory.shadow);
  ErrorEstimate::Tally& tally = memory.tally;
  for (double* value : {&tally.time, &tally.ratio_time, &tally.value, &tally.vibration.amplitude, &tally.vibration.frequency, &tally.kept,
                        &tally.damped_away})
    archive.number(*value);
  archive.numbers(tally.slopes.data(), tally.slopes.size());
  archive.integer(tally.steps);
  archive.choice(tally.lost, true);
}

}  // namespace softffd::fmi
