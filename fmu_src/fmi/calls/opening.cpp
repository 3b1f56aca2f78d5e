#include "calls/opening.hpp"

namespace softffd::fmi {

void check_asked(const Asked& asked) {
  const std::string name = asked.name ? asked.name : "";
  if (name.find_first_not_of(" \t\r\n\v\f") == name.npos)
    throw CallError(std::string("instanceName: wanted a text, got nothing") + (name.empty() ? "" : " but blanks"));
  if (!asked.token) throw CallError(std::string(asked.token_word) + ": wanted a text, got null");
}

SceneFile required(SceneFile scene, const Asked& asked) {
  if (scene.guid != asked.token) throw CallError(std::string(asked.token_word) + ": wanted " + scene.guid + ", got " + asked.token);
  return scene;
}

SceneFile scene_in(const std::string& folder, const Asked& asked) {
  const bool ended = folder.ends_with('/');
  return required(read_scene(folder + (ended ? "scene.txt" : "/scene.txt")), asked);
}

}  // namespace softffd::fmi
