/// FNV-1a, 64 bits: the checksum of resources files and of FMU states. It finds damage, not malice.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace softffd::fmi {

inline std::uint64_t fnv1a(std::span<const unsigned char> bytes) {
  std::uint64_t hash = 14695981039346656037u;
  for (unsigned char c : bytes) hash = (hash ^ c) * 1099511628211u;
  return hash;
}

inline std::uint64_t fnv1a(std::string_view text) {
  return fnv1a(std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size()));
}

}  // namespace softffd::fmi
