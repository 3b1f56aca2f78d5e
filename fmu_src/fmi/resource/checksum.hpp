/// CRC-32, as in zlib: the checksum of resources files and of FMU states. It detects damage, but not malicious changes.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace softffd::fmi {

/// Processes eight bytes at a time: tables[k] contains the contribution of a byte that is followed by k bytes.
inline std::uint32_t crc32(std::span<const unsigned char> bytes) {
  static constexpr auto tables = [] {
    std::array<std::array<std::uint32_t, 256>, 8> made{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
      made[0][byte] = byte;
      for (int bit = 0; bit < 8; ++bit) made[0][byte] = (made[0][byte] >> 1) ^ (made[0][byte] & 1 ? 0xedb88320u : 0);
    }
    for (int k = 1; k < 8; ++k)
      for (int byte = 0; byte < 256; ++byte) made[k][byte] = (made[k - 1][byte] >> 8) ^ made[0][made[k - 1][byte] & 0xff];
    return made;
  }();
  std::uint32_t value = ~0u;
  for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
    std::uint32_t next = 0;
    for (int k = 0; k < 8; ++k) next ^= tables[7 - k][bytes[k] ^ (k < 4 ? value >> 8 * k & 0xff : 0)];
    value = next;
  }
  for (unsigned char c : bytes) value = (value >> 8) ^ tables[0][(value ^ c) & 0xff];
  return ~value;
}

inline std::uint32_t crc32(std::string_view text) {
  return crc32(std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size()));
}

}  // namespace softffd::fmi
