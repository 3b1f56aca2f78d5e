/// An FMU state as bytes: flat, no pointers, little-endian, no padding.
///
/// In memory a state is the payload alone. A serialized state has a head: magic number, format version, payload size and checksum of the
/// payload, eight bytes each, and the scene's GUID. Another instance or process with the same scene restores the same bits. Any other bytes
/// are refused.
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

/// Thrown for bytes that are not a state of this scene; what() is the reason.
struct StateError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Returns the serialized state.
Bytes with_head(const std::string& guid, const Bytes& payload);
/// Returns the payload of a serialized state. Throws StateError if the head does not fit the GUID or the payload.
Bytes without_head(const std::string& guid, std::span<const unsigned char> serialized);
inline std::size_t head_size(const std::string& guid) { return 32 + guid.size(); }

inline std::uint64_t little_endian(std::uint64_t word) {
  if constexpr (std::endian::native == std::endian::little) return word;
  std::uint64_t turned = 0;
  for (int i = 0; i < 8; ++i) turned |= (word >> 8 * i & 0xff) << 8 * (7 - i);
  return turned;
}

/// Counts the bytes that a StateWriter appends.
struct StateSize {
  std::size_t bytes = 0;
  void number(double&) { bytes += 8; }
  void integer(Count&) { bytes += 8; }
  template <class Choice>
  void choice(Choice&, Choice) {
    bytes += 8;
  }
  void numbers(double*, std::size_t count) { bytes += 8 * count; }
};

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

/// Reads values in the same order. Throws StateError at the end of the bytes, for NaN, and for values that are not among the choices.
class StateReader {
 public:
  explicit StateReader(std::span<const unsigned char> bytes) : rest_(bytes) {}
  void number(double& value) {
    value = std::bit_cast<double>(word());
    if (value != value) throw StateError("a value of the state is not a number");
  }
  void integer(Count& value) { value = Count(word()); }
  /// Reads a value of an enumeration, at most `last`, or a flag.
  template <class Choice>
  void choice(Choice& value, Choice last) {
    const std::uint64_t number = word();
    if (number > std::uint64_t(last)) throw StateError("a value of the state is not among the allowed ones");
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

/// Passes every value of a Run, or of the memory of an error estimate, to a StateWriter or StateReader, in the order of its fields.
template <class Archive, Visited Value>
void pass(Archive& archive, Value& value) {
  each_leaf(value, [&](auto& leaf) {
    using Leaf = std::remove_reference_t<decltype(leaf)>;
    if constexpr (std::is_same_v<Leaf, double>)
      archive.number(leaf);
    else if constexpr (std::is_same_v<Leaf, Count>)
      archive.integer(leaf);
    else if constexpr (std::is_same_v<Leaf, bool>)
      archive.choice(leaf, true);
    else if constexpr (std::is_enum_v<Leaf>)
      archive.choice(leaf, last(leaf));
    else
      archive.numbers(leaf.data(), leaf.size());
  });
}

}  // namespace softffd::fmi
