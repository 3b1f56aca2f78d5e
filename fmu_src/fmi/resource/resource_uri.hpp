/// Converts the resource location that a host passes into a path on disk.
#pragma once
#include <string>
#include <string_view>

namespace softffd::fmi {

/// Returns the path of a URI file:/x, file:///x, file:////x (as some hosts write it) or file://localhost/x, with the scheme in upper or
/// lower case and percent-encoded UTF-8. Throws SceneFileError for any other URI.
std::string path_from_uri(std::string_view uri);

}  // namespace softffd::fmi
