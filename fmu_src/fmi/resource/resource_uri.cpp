#include "resource/resource_uri.hpp"

#include <algorithm>

#include "resource/scene_file.hpp"

namespace softffd::fmi {

namespace {

bool starts_with_any_case(std::string_view text, std::string_view lower) {
  if (text.size() < lower.size()) return false;
  for (std::size_t i = 0; i < lower.size(); ++i) {
    const char c = text[i] >= 'A' && text[i] <= 'Z' ? char(text[i] - 'A' + 'a') : text[i];
    if (c != lower[i]) return false;
  }
  return true;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

[[noreturn]] void refuse(const std::string& wanted, std::string_view uri) {
  throw SceneFileError("fmuResourceLocation: wanted " + wanted + ", got " + std::string(uri));
}

std::string percent_decoded(std::string_view text, std::string_view uri) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
      continue;
    }
    const bool complete = i + 2 < text.size();
    const int high = complete ? hex_digit(text[i + 1]) : -1, low = complete ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0 || (high == 0 && low == 0)) refuse("two hexadecimal digits, not 00, after each % of the URI", uri);
    decoded += char(16 * high + low);
    i += 2;
  }
  return decoded;
}

}  // namespace

std::string path_from_uri(std::string_view uri) {
  const std::string_view whole = uri;
  if (!starts_with_any_case(uri, "file:")) refuse("a file: URI", whole);
  uri.remove_prefix(5);
  if (starts_with_any_case(uri, "//localhost/"))
    uri.remove_prefix(11);
  else if (starts_with_any_case(uri, "///"))
    uri.remove_prefix(std::min(uri.find_first_not_of('/', 2), uri.size()) - 1);
  if (uri.starts_with("//")) refuse("a URI without a host, or with localhost", whole);
  if (!uri.starts_with('/')) refuse("an absolute path in the URI", whole);
  std::string path = percent_decoded(uri, whole);
#ifdef _WIN32
  if (path.size() > 2 && path[2] == ':') path.erase(0, 1);  // /C:/x
#endif
  return path;
}

}  // namespace softffd::fmi
