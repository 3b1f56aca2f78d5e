/// From the resource location that a host hands over to a path on disk.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace softffd::fmi {

/// file:/x, file:///x, file:////x (as some hosts write it), file://localhost/x, scheme in any case, percent-encoded UTF-8. Empty optional:
/// not such a URI.
std::optional<std::string> path_from_uri(std::string_view uri);

}  // namespace softffd::fmi
