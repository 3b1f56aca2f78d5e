/// From what a host asks for to a new instance, as both standards have it.
#pragma once
#include "calls/exception_storage.hpp"
#include "calls/float_environment.hpp"
#include "calls/registry.hpp"
#include "instance/instance.hpp"

namespace softffd::fmi {

/// What a standard calls the arguments, for messages, and what the host gave for them.
struct Asked {
  const char* name;        ///< the instance's
  const char* token_word;  ///< "fmuGUID" or "instantiationToken"
  const char* token;
};

/// The scene, if it is that of the token. Throws CallError.
SceneFile required(SceneFile scene, const Asked& asked);
/// The same of the one in a resources folder [UTF-8]. Throws SceneFileError too.
SceneFile scene_in(const std::string& folder, const Asked& asked);
/// Throws CallError for an instance without a name and for a null token.
void check_asked(const Asked& asked);

/// The handle of a new instance, or null, and the log has the reason. logger(): the host's. scene(): may throw CallError.
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
    } catch (const CallError& error) {
      logger.log(fmi2Error, log_error, std::string(function) + ": " + error.what());
    } catch (const std::exception& error) {
      logger.log(fmi2Error, log_error, error.what());
    }
  } catch (...) {  // no memory for the message either
  }
  return nullptr;
}

}  // namespace softffd::fmi
