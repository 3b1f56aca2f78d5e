#include "resource/resource_uri.hpp"

#include "check.hpp"

using softffd::fmi::path_from_uri;

TEST(every_spelling_of_a_file_uri_gives_the_path) {
  for (const char* uri : {"file:/tmp/a b", "file:///tmp/a%20b", "FILE://localhost/tmp/a%20b", "File:///tmp/a b", "file:////tmp/a%20b"})
    CHECK(path_from_uri(uri) == "/tmp/a b");
  CHECK(path_from_uri("file:///tmp/%C3%A4%25") == "/tmp/\xC3\xA4%");
}

TEST(anything_else_is_refused) {
  for (const char* uri : {"", "/tmp/x", "http://x/y", "file:", "file:tmp", "file://host/x", "file:///a%2", "file:///a%zz", "file:///a%00b"})
    CHECK(!path_from_uri(uri));
}
