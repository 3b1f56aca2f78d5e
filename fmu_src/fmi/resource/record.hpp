/// One record of the resources file: a line of words and numbers, which are read one by one. Errors throw SceneFileError.
#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "resource/scene_file.hpp"

namespace softffd::fmi {

class Record {
 public:
  Record(std::string_view line, int number) : rest_(line), number_(number) {}

  std::string_view word() {
    const std::size_t begin = rest_.find_first_not_of(' ');
    if (begin == rest_.npos) fail("a value is missing");
    rest_.remove_prefix(begin);
    const std::size_t end = std::min(rest_.find(' '), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return word;
  }
  bool more() const { return rest_.find_first_not_of(' ') != rest_.npos; }

  double number() {
    const std::string_view text = word();
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) fail("wanted a finite number");
    return value;
  }
  double at_least(double least) {
    const double value = number();
    if (value < least) fail("a number is below its least value");
    return value;
  }
  double positive() {
    const double value = number();
    if (!(value > 0)) fail("wanted a number above 0");
    return value;
  }
  int integer(int least, int most) {
    const double value = number();
    if (!(value >= least && value <= most) || value != std::floor(value)) fail("an integer is out of range");
    return int(value);
  }
  Vec3 vector() {
    Vec3 v;
    for (int a = 0; a < 3; ++a) v[a] = number();
    return v;
  }
  std::vector<int> points(int count) {
    std::vector<int> list;
    while (more()) list.push_back(integer(0, count - 1));
    return list;
  }
  template <class T>
  T choice(const std::map<std::string_view, T>& choices) {
    const auto found = choices.find(word());
    if (found == choices.end()) fail("an unknown word");
    return found->second;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw SceneFileError("resources/scene.txt, line " + std::to_string(number_) + ": " + what);
  }

 private:
  std::string_view rest_;
  int number_;
};

}  // namespace softffd::fmi
