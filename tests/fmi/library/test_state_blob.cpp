#include "instance/state_blob.hpp"

#include <limits>

#include "instances.hpp"
#include "resource/checksum.hpp"

using namespace softffd::fmi;
using softffd::Count;

namespace {

enum class Colour { red, green, blue };

const Bytes payload{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
const std::string guid = "{guid}";

/// What a serialized state is refused with; empty: it is taken.
std::string loading(const Bytes& serialized, const std::string& scene = guid) {
  return refusal<StateError>([&] { without_head(scene, serialized); });
}

template <class Value, class Read>
bool refused(Value value, Read&& read) {
  Bytes bytes;
  StateWriter(bytes).integer(value);
  StateReader reader(bytes);
  return !refusal<StateError>([&] { read(reader); }).empty();
}

Count word_of(double value) { return std::bit_cast<Count>(value); }

}  // namespace

TEST(what_is_written_is_read_bit_by_bit) {
  using Limits = std::numeric_limits<double>;
  double numbers[] = {0.0, -0.0, 0.1, -1e300, Limits::denorm_min(), Limits::infinity(), -Limits::infinity()};
  Count count = -5;
  Colour colour = Colour::blue;
  Bytes bytes;
  StateWriter writer(bytes);
  writer.numbers(numbers, std::size(numbers));
  writer.integer(count);
  writer.choice(colour, Colour::blue);
  CHECK(bytes.size() == 8 * (std::size(numbers) + 2));

  StateReader reader(bytes);
  for (double number : numbers) {
    double value = 7;
    reader.number(value);
    CHECK(word_of(value) == word_of(number));
  }
  Count read_count = 0;
  Colour read_colour = Colour::red;
  reader.integer(read_count);
  CHECK(!reader.at_end());
  reader.choice(read_colour, Colour::blue);
  CHECK(read_count == count && read_colour == colour && reader.at_end());
}

TEST(words_are_stored_lowest_byte_first) {
  Bytes bytes;
  Count value = 0x0102030405060708;
  StateWriter(bytes).integer(value);
  CHECK((bytes == Bytes{8, 7, 6, 5, 4, 3, 2, 1}));
}

TEST(numbers_that_are_none_and_choices_that_there_are_not_are_refused) {
  const auto number = [](StateReader& r) {
    double value;
    r.number(value);
  };
  const auto colour = [](StateReader& r) {
    Colour value;
    r.choice(value, Colour::blue);
  };
  CHECK(!refused(word_of(1.5), number) && refused(word_of(std::numeric_limits<double>::quiet_NaN()), number));
  CHECK(!refused(Count(2), colour) && refused(Count(3), colour) && refused(Count(-1), colour));
}

TEST(reading_past_the_end_is_refused) {
  for (std::size_t length : {0, 1, 7}) {
    const Bytes bytes(length, 0);
    StateReader reader(bytes);
    Count value;
    CHECK(!refusal<StateError>([&] { reader.integer(value); }).empty());
  }
}

TEST(a_serialized_state_is_its_head_and_the_payload) {
  for (const Bytes& content : {payload, Bytes()}) {
    const Bytes whole = with_head(guid, content);
    CHECK(whole.size() == head_size(guid) + content.size() && without_head(guid, whole) == content);
  }
}

TEST(every_changed_byte_of_a_serialized_state_is_noticed) {
  const Bytes good = with_head(guid, payload);
  for (std::size_t i = 0; i < good.size(); ++i)
    for (unsigned char bit = 1; bit; bit <<= 1) {
      Bytes bad = good;
      bad[i] ^= bit;
      CHECK(!loading(bad).empty());
    }
}

TEST(a_refusal_says_what_is_wrong_with_the_bytes) {
  const Bytes good = with_head(guid, payload);
  const auto changed = [&](std::size_t at) {
    Bytes bad = good;
    ++bad[at];
    return loading(bad);
  };
  Bytes longer = good, shorter = good;
  longer.push_back(0);
  shorter.pop_back();
  CHECK(loading(good).empty());
  CHECK(changed(0) == "the bytes are not a state of a softffd component");
  CHECK(changed(8) == "the state has another format version");
  CHECK(changed(16) == "the state has the wrong size" && loading(longer) == changed(16) && loading(shorter) == changed(16));
  CHECK(changed(24) == "the state is damaged: its checksum does not fit" && changed(head_size(guid)) == changed(24));
  CHECK(changed(32) == "the state belongs to another scene" && changed(head_size(guid) - 1) == changed(32));
  CHECK(loading(good, "{other}") == changed(32));
  for (std::size_t length = 0; length < head_size(guid); ++length)
    CHECK(loading(Bytes(good.begin(), good.begin() + length)) == "the state is too short");
}

TEST(the_checksum_is_crc_32) {
  CHECK(crc32("") == 0 && crc32("123456789") == 0xcbf43926 && crc32(Bytes{'1', '2', '3', '4', '5', '6', '7', '8', '9'}) == 0xcbf43926);
}
