/// The resolved scene in the FMU's resources: a flat, versioned, checksummed text that the Python package writes.
///
/// The first line is `softffd-scene 2 CHECKSUM`, with the CRC-32 (hexadecimal) of everything after that line. Each further line is a
/// record: a key and its values, separated by blanks. Numbers do not depend on the locale. A record that the scene does not need is absent.
#pragma once
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "model/basis.hpp"
#include "soft_body.hpp"

namespace softffd::fmi {

/// Thrown for a resources file that cannot be used; what() says where and why.
struct SceneFileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct SceneFile {
  /// Components of pose and motion that are inputs, such as point.z; the others are parameters. Absent: all are inputs.
  using Chosen = std::optional<std::set<std::string, std::less<>>>;
  struct Plane : PlaneMotion {
    std::string name;
    Chosen inputs;
    int free = -1;  ///< index among the free bodies of the definition; -1: not free
    std::string kind() const { return !solid() ? "plane" : box() ? "box" : length > 0 ? "cylinder" : "sphere"; }
    std::string path() const { return kind() + "." + name; }  ///< beginning of the names of its variables
  };
  struct Pin {
    std::string name;
    bool moved_by_input = false;
    Chosen inputs;
    std::optional<PinMotion> start;  ///< initial pose; absent: the pose at rest
    int free = -1;                   ///< index among the free bodies; -1: not free
    std::string path() const { return "pin." + name; }
  };
  struct Load {
    std::string name;
    std::vector<int> points;
    std::vector<double> weights;  ///< (points) fractions of the load, which sum to 1
  };
  struct Probe {
    std::string name;
    Vec3 at;
    bool stress = false, von_mises = false, stretch = false;  ///< outputs; only in a solid
    bool velocity = false, acceleration = false, maximum = false;
    int followed = -1;  ///< index among the followed points of the definition; -1: not followed
  };

  struct Taxel {
    int sensor;
    std::array<int, 2> at;
  };

  std::string guid;
  Definition definition;
  Stiffness stiffness;                   ///< of springs, in a scene without modulus
  std::optional<double> modulus;         ///< Young's modulus [Pa]
  std::optional<double> poissons_ratio;  ///< of a solid [1]
  std::optional<double> damping;
  std::optional<double> internal_damping;  ///< [s]
  std::optional<Vec3> gravity;
  std::optional<Vec3> rotation;  ///< initial rotation vector of the body [rad]
  std::vector<Plane> planes;
  std::vector<Pin> pins;
  std::vector<Load> loads;
  std::vector<Probe> probes;
  std::vector<std::string> sensors;                ///< names of the patches of the definition
  std::vector<Taxel> taxels;                       ///< of all sensors, row by row
  std::vector<Vec3> samples;                       ///< of the surface, at rest [m]; empty: planes meet the control points
  std::vector<int> forces, positions, velocities;  ///< control points with a variable
  bool flat_names = false;                         ///< position_0_1_2_x instead of position[0,1,2].x
  bool reactions = false, energy = false, solver = false, error_estimate = false;
  int method = 1;
  double tolerance = 1e-4, step = 0;
  int threads = 1;
  double most_work = Settings{}.most_work;
  double stop_time = 1;  ///< of the default experiment, which starts at 0 [s]
};

/// Parses the text of a resources file. Throws SceneFileError.
SceneFile parse_scene(std::string_view text);

/// Reads and parses a file. Throws SceneFileError.
SceneFile read_scene(const std::string& path);

}  // namespace softffd::fmi
