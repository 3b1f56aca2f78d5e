/// The checksums of resources files, CRC-32 as zlib has it, and of FMU states, FNV-1a of 64 bits. They find damage, not malice.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace softffd::fmi {

inline std::uint32_t crc32(std::string_view text) {
  static constexpr auto table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t byte = 0; byte < made.size(); ++byte) {
      made[byte] = byte;
      for (int bit = 0; bit < 8; ++bit) made[byte] = (made[byte] >> 1) ^ (made[byte] & 1 ? 0xedb88320u : 0);
    }
    return made;
  }();
  std::uint32_t value = ~0u;
  for (unsigned char c : text) value = (value >> 8) ^ table[(value ^ c) & 0xff];
  return ~value;
}

inline std::uint64_t fnv1a(std::span<const unsigned char> bytes) {
  std::uint64_t hash = 14695981039346656037u;
  for (unsigned char c : bytes) hash = (hash ^ c) * 1099511628211u;
  return hash;
}

inline std::uint64_t fnv1a(std::string_view text) {
  return fnv1a(std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size()));
}

}  // namespace softffd::fmi
