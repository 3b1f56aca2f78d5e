/// Small scenes for tests of the component, as the text that FMUs carry in their resources, and as a folder that fmi2Instantiate reads.
#pragma once
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <string_view>

namespace small_scene {

/// CRC-32, the checksum of the format.
inline std::uint32_t hash_of(std::string_view text) {
  std::uint32_t hash = ~0u;
  for (unsigned char c : text) {
    hash ^= c;
    for (int bit = 0; bit < 8; ++bit) hash = (hash >> 1) ^ (hash & 1 ? 0xedb88320u : 0);
  }
  return ~hash;
}

/// The records with the first line that belongs to them.
inline std::string with_first_line(std::string_view records) {
  char line[64];
  std::snprintf(line, sizeof line, "softffd-scene 2 %08lx\n", static_cast<unsigned long>(hash_of(records)));
  return std::string(line).append(records);
}

/// A cube of side^3 control points whose guid is {g}; `parts` are the records that the test adds.
struct Box {
  int side = 3;
  double mass = 0.037;      ///< of one control point [kg]
  double stiffness = 1000;  ///< [N/m]
  std::string initial = "1.1 1 0.9 0 0 0.02 1 0 -1 0 2 0";

  std::string records(const std::string& parts) const {
    std::ostringstream out;
    out << "guid {g}\ncounts " << side << ' ' << side << ' ' << side << "\nmass";
    for (int p = 0; p < side * side * side; ++p) out << ' ' << mass;
    out << "\nstiffness " << stiffness << ' ' << stiffness << ' ' << stiffness << "\npositions";
    for (int p = 0; p < side * side * side; ++p) out << ' ' << p;
    out << "\ninitial " << initial << '\n' << parts;
    return out.str();
  }
  std::string text(const std::string& parts) const { return with_first_line(records(parts)); }
  /// Writes the scene to a folder of its own, whose name holds a blank and a percent sign, and returns the folder's URI.
  std::string resources(const std::string& parts) const {
    const std::string content = text(parts), name = std::to_string(hash_of(content));
    const auto folder = std::filesystem::temp_directory_path() / ("softffd test %" + name);
    std::filesystem::create_directories(folder);
    static const std::string mine = std::to_string(std::random_device{}());  // other programs may read the scene meanwhile
    std::ofstream(folder / mine, std::ios::binary) << content;
    std::filesystem::rename(folder / mine, folder / "scene.txt");
    const std::string path = folder.generic_string();
    std::string uri = path[0] == '/' ? "file://" : "file:///";  // C:/... on Windows
    for (char c : path) uri.append(c == ' ' ? "%20" : c == '%' ? "%25" : std::string(1, c));
    return uri;
  }
};

}  // namespace small_scene
