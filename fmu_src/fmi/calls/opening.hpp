/// Creates a new instance from the arguments of a host, for both standards.
#pragma once
#include "calls/exception_storage.hpp"
#include "calls/float_environment.hpp"
#include "calls/registry.hpp"
#include "instance/instance.hpp"

namespace softffd::fmi {

/// The arguments that the host passed, and the standard's name of the token for messages.
struct Asked {
  const char* name;        ///< of the instance
  const char* token_word;  ///< "fmuGUID" or "instantiationToken"
  const char* token;
};

/// Returns the scene if its GUID is the token. Throws CallError otherwise.
SceneFile required(SceneFile scene, const Asked& asked);
/// Does the same for the scene in a resources folder, whose path is in UTF-8. May also throw SceneFileError.
SceneFile scene_in(const std::string& folder, const Asked& asked);
/// Throws CallError for an instance without a name and for a null token.
void check_asked(const Asked& asked);

/// Returns the handle of a new instance, or null with the reason in the log. make_logger(): returns the logger of the host. find_scene():
/// returns the scene; may throw CallError.
template <class Held, class MakeLogger, class FindScene>
Held* instantiate(Registry<Held>& registry, const char* function, const Asked& asked, MakeLogger&& make_logger,
                  FindScene&& find_scene) noexcept {
  const FloatEnvironment environment;
  claim_exception_storage();
  try {
    const Logger logger = make_logger();
    try {
      check_asked(asked);
      return registry.adopt(std::make_unique<Held>(find_scene(), logger));
    } catch (const std::exception& error) {
      logger.log(fmi2Error, log_error, std::string(function) + ": " + error.what());
    }
  } catch (...) {  // there is no memory even for the message
  }
  return nullptr;
}

}  // namespace softffd::fmi
