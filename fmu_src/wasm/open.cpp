/// Creates an instance from the text of its scene. In WebAssembly this replaces fmi2Instantiate, which reads a file. All other functions
/// are those of FMI 2.0. The caller is python/softffd/show/live_component.js.
#include "calls/fmi2.hpp"
#include "calls/opening.hpp"
#include "machine/exported.hpp"

using namespace softffd::fmi;

/// Receives the messages of all instances, like a logger of FMI 2.0.
extern "C" __attribute__((import_module("softffd"), import_name("log"))) void softffd_log(int status, const char* category,
                                                                                          const char* text);

/// Returns a new instance of the resolved scene in a UTF-8 text of `length` bytes, or null, with the reason in the log, if the text or its
/// GUID is not as wanted.
SOFTFFD_EXPORTED fmi2Component softffd_open(const char* text, std::size_t length, const char* guid) {
  const Asked asked{"softffd", "fmuGUID", guid};
  return instantiate(
      instances, "softffd_open", asked,
      [] { return Logger(softffd_log, "", {std::begin(log_categories), std::end(log_categories)}, false); },
      [&] { return required(parse_scene({text, length}), asked); });
}
