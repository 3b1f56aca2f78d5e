#include "instance/state_blob.hpp"

#include <algorithm>
#include <array>

#include "resource/checksum.hpp"

namespace softffd::fmi {

namespace {

constexpr std::uint64_t magic = 0x3144464646544f53, version = 23;

}  // namespace

Bytes with_head(const std::string& guid, const Bytes& payload) {
  Bytes bytes;
  bytes.reserve(head_size(guid) + payload.size());
  for (const std::uint64_t word : {magic, version, std::uint64_t(payload.size()), std::uint64_t(crc32(payload))}) {
    const std::uint64_t stored = little_endian(word);
    const auto* begin = reinterpret_cast<const unsigned char*>(&stored);
    bytes.insert(bytes.end(), begin, begin + 8);
  }
  bytes.insert(bytes.end(), guid.begin(), guid.end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

Bytes without_head(const std::string& guid, std::span<const unsigned char> serialized) {
  std::array<std::uint64_t, 4> words{};
  if (serialized.size() < head_size(guid)) throw StateError("the state is too short");
  std::memcpy(words.data(), serialized.data(), sizeof words);
  for (std::uint64_t& word : words) word = little_endian(word);
  const auto payload = serialized.subspan(head_size(guid));
  if (words[0] != magic) throw StateError("the bytes are not a state of a softffd component");
  if (words[1] != version) throw StateError("the state has another format version");
  if (!std::equal(guid.begin(), guid.end(), serialized.begin() + sizeof words, [](char a, unsigned char b) { return a == char(b); }))
    throw StateError("the state belongs to another scene");
  if (words[2] != payload.size()) throw StateError("the state has the wrong size");
  if (words[3] != crc32(payload)) throw StateError("the state is damaged: its checksum does not fit");
  return Bytes(payload.begin(), payload.end());
}

}  // namespace softffd::fmi
