#include "resource/resource_uri.hpp"

#include <algorithm>

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

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
      continue;
    }
    const bool complete = i + 2 < text.size();
    const int high = complete ? hex_digit(text[i + 1]) : -1, low = complete ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0 || (high == 0 && low == 0)) return std::nullopt;
    decoded += char(16 * high + low);
    i += 2;
  }
  return decoded;
}

}  // namespace

std::optional<std::string> path_from_uri(std::string_view uri) {
  if (!starts_with_any_case(uri, "file:")) return std::nullopt;
  uri.remove_prefix(5);
  if (starts_with_any_case(uri, "//localhost/"))
    uri.remove_prefix(11);
  else if (starts_with_any_case(uri, "///"))
    uri.remove_prefix(std::min(uri.find_first_not_of('/', 2), uri.size()) - 1);
  if (uri.empty() || uri[0] != '/' || (uri.size() > 1 && uri[1] == '/')) return std::nullopt;
  auto path = percent_decoded(uri);
#ifdef _WIN32
  if (path && path->size() > 2 && (*path)[2] == ':') path->erase(0, 1);  // /C:/x
#endif
  return path;
}

}  // namespace softffd::fmi
