#include "resource/resource_uri.hpp"

#include "instances.hpp"

using softffd::fmi::path_from_uri;

TEST(every_spelling_of_a_file_uri_gives_the_path) {
  for (const char* uri : {"file:/tmp/a b", "file:///tmp/a%20b", "FILE://localhost/tmp/a%20b", "File:///tmp/a b", "file:////tmp/a%20b"})
    CHECK(path_from_uri(uri) == "/tmp/a b");
  CHECK(path_from_uri("file:///tmp/%C3%A4%25") == "/tmp/\xC3\xA4%");
}

TEST(anything_else_is_refused_with_what_was_wanted) {
  const auto refused = [](const std::string& uri, const std::string& wanted) {
    return softffd::fmi::refusal<softffd::fmi::SceneFileError>([&] { path_from_uri(uri); }) ==
           "fmuResourceLocation: wanted " + wanted + ", got " + uri;
  };
  for (const char* uri : {"", "/tmp/x", "http://x/y"}) CHECK(refused(uri, "a file: URI"));
  for (const char* uri : {"file:", "file:tmp"}) CHECK(refused(uri, "an absolute path in the URI"));
  for (const char* uri : {"file:///a%2", "file:///a%zz", "file:///a%00b"})
    CHECK(refused(uri, "two hexadecimal digits, not 00, after each % of the URI"));
  CHECK(refused("file://host/x", "a URI without a host, or with localhost"));
}
