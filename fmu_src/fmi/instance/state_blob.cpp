#include "instance/state_blob.hpp"

#include "resource/checksum.hpp"

namespace softffd::fmi {

namespace {

constexpr std::uint64_t magic = 0x3144464646544f53, version = 14;

}  // namespace

Bytes with_head(const std::string& guid, const Bytes& payload) {
  Bytes bytes;
  bytes.reserve(head_size + payload.size());
  for (const std::uint64_t word : {magic, version, fnv1a(guid), std::uint64_t(payload.size()), fnv1a(payload)}) {
    const std::uint64_t stored = little_endian(word);
    const auto* begin = reinterpret_cast<const unsigned char*>(&stored);
    bytes.insert(bytes.end(), begin, begin + 8);
  }
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

Bytes without_head(const std::string& guid, std::span<const unsigned char> serialized) {
  std::array<std::uint64_t, 5> head{};
  if (serialized.size() < head_size) throw StateError("the state is too short");
  std::memcpy(head.data(), serialized.data(), head_size);
  for (std::uint64_t& word : head) word = little_endian(word);
  const auto payload = serialized.subspan(head_size);
  if (head[0] != magic) throw StateError("the bytes are no state of a softffd component");
  if (head[1] != version) throw StateError("the state has another version of the format");
  if (head[2] != fnv1a(guid)) throw StateError("the state belongs to another scene");
  if (head[3] != payload.size()) throw StateError("the state has the wrong size");
  if (head[4] != fnv1a(payload)) throw StateError("the state is damaged: its checksum does not fit");
  return Bytes(payload.begin(), payload.end());
}

}  // namespace softffd::fmi
