#include "forces/spring_kinds.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace softffd {

namespace {

constexpr int nobody = -1;

/// Returns the FNV-1a hash of the bits, eight bytes at a time; the high half, because it is better mixed.
std::size_t hash(const SpringKinds::Kind& kind) {
  std::uint64_t value = 14695981039346656037u;
  for (const SpringKinds::Material& material : kind)
    for (const double* numbers : {material.stiffness, material.rest_length})
      for (int lane = 0; lane < SpringKinds::lanes; ++lane) value = (value ^ std::bit_cast<std::uint64_t>(numbers[lane])) * 1099511628211u;
  return value >> 32;
}

}  // namespace

SpringKinds::SpringKinds(int blocks) : places_(2 * std::bit_ceil(unsigned(blocks)), nobody) {
  kinds_.reserve(blocks);
  of_block_.reserve(blocks);
}

void SpringKinds::clear() {
  kinds_.clear();
  of_block_.clear();
  std::fill(places_.begin(), places_.end(), nobody);
}

void SpringKinds::add(const Kind& kind) {
  const std::size_t last = places_.size() - 1;
  std::size_t at = hash(kind) & last;
  while (places_[at] != nobody && std::memcmp(&kinds_[places_[at]], &kind, sizeof kind) != 0) at = (at + 1) & last;
  if (places_[at] == nobody) {
    places_[at] = different();
    kinds_.push_back(kind);
  }
  of_block_.push_back(places_[at]);
}

}  // namespace softffd
