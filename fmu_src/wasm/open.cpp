/// What the component has in WebAssembly in the place of fmi2Instantiate, which reads a file: an instance from its scene's text. All else
/// is FMI 2.0. python/softffd/show/live_component.js is the other side.
#include "calls/fmi2.hpp"
#include "calls/opening.hpp"
#include "machine/exported.hpp"

using namespace softffd::fmi;

/// Takes the messages of all instances, as a logger of FMI 2.0 does.
extern "C" __attribute__((import_module("softffd"), import_name("log"))) void softffd_log(int status, const char* category,
                                                                                          const char* text);

/// A new instance of the resolved scene in a text [UTF-8] of so many bytes, if its GUID is the one given. Null otherwise, and the log has
/// the reason.
SOFTFFD_EXPORTED fmi2Component softffd_open(const char* text, std::size_t length, const char* guid) {
  const Asked asked{"softffd", "fmuGUID", guid};
  return instantiate(
      instances, "softffd_open", asked, [] { return Logger(softffd_log, "", false); },
      [&] { return required(parse_scene({text, length}), asked); });
}
