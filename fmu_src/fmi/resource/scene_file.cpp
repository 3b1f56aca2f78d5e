#include "resource/scene_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>

#include "methods/traits.hpp"
#include "model/lobatto.hpp"
#include "resource/checksum.hpp"
#include "resource/record.hpp"
#include "variable_table.hpp"

namespace softffd::fmi {

namespace {

/// Fraction of a side by which rounding may take a sample out of the box.
constexpr double outside = 1e-9;
/// Rounding of the square of a unit vector.
constexpr double rounding = 1e-12;
/// Largest number of taxels along a side of a sensor.
constexpr int most_taxels = 64;

struct Reader {
  std::string_view key;
  void (*read)(Record&, SceneFile&);
};

int count(const SceneFile& s) { return s.definition.lattice.points(); }

void read_counts(Record& r, SceneFile& s) {
  const Definition& d = s.definition;
  if (!(d.mass.empty() && d.regions.empty() && d.pins.empty() && s.loads.empty() && s.forces.empty() && s.positions.empty() &&
        s.velocities.empty()))
    r.fail("the counts come after records that depend on them");
  for (int& n : s.definition.lattice.counts) n = r.integer(2, most_points);
}
void read_size(Record& r, SceneFile& s) {
  for (int a = 0; a < 3; ++a) s.definition.lattice.size[a] = r.positive();
}
void read_mass(Record& r, SceneFile& s) {
  while (r.more()) s.definition.mass.push_back(r.positive());
  if (int(s.definition.mass.size()) != count(s)) r.fail("wanted one mass per control point");
}
void read_weight(Record& r, SceneFile& s) {
  while (r.more()) s.definition.weight.push_back(r.at_least(0));
  if (int(s.definition.weight.size()) != count(s)) r.fail("wanted one weight per control point");
  if (std::all_of(s.definition.weight.begin(), s.definition.weight.end(), [](double w) { return w == 0; })) r.fail("no weight is above 0");
}
template <auto field>
void read_region(Record& r, SceneFile& s) {
  Region region;
  region.*field = r.at_least(0);
  region.points = r.points(count(s));
  s.definition.regions.push_back(region);
}
void read_plane(Record& r, SceneFile& s) {
  SceneFile::Plane plane;
  plane.name = r.word();
  plane.moved_by_input = r.choice<bool>({{"input", true}, {"fixed", false}});
  plane.point = r.vector();
  plane.normal = r.vector();
  if (plane.normal.isZero(0)) r.fail("a plane's normal is zero");
  plane.velocity = r.vector();
  plane.angular_velocity = r.vector();
  plane.friction = r.at_least(0);
  s.planes.push_back(plane);
  s.definition.planes = int(s.planes.size());
}
/// Turns the plane of the record before into a solid around its point: a sphere or cylinder; `read_box` makes it a box.
void read_solid(Record& r, SceneFile& s) {
  if (s.planes.empty()) r.fail("there is no plane before it");
  s.planes.back().radius = r.positive();
  s.planes.back().length = r.at_least(0);
}
void read_box(Record& r, SceneFile& s) {
  if (s.planes.empty()) r.fail("there is no plane before it");
  for (int axis = 0; axis < 3; ++axis) s.planes.back().sides[axis] = r.positive();
  s.planes.back().rotation = r.vector();
}
void read_pin(Record& r, SceneFile& s) {
  SceneFile::Pin pin;
  pin.name = r.word();
  pin.moved_by_input = r.choice<bool>({{"input", true}, {"fixed", false}});
  s.pins.push_back(pin);
  s.definition.pins.push_back({r.points(count(s)), {}});
  if (s.definition.pins.back().points.empty()) r.fail("a pin without points");
}
void read_pin_origin(Record& r, SceneFile& s) {
  if (s.definition.pins.empty()) r.fail("there is no pin before it");
  s.definition.pins.back().origin = r.vector();
}
void read_pin_start(Record& r, SceneFile& s) {
  if (s.pins.empty()) r.fail("there is no pin before it");
  PinMotion& start = s.pins.back().start.emplace();
  start.position = r.vector();
  for (double& component : start.orientation) component = r.number();
}
/// Makes the obstacle or pin of the record before a free body.
template <class Moved>
void make_free(Record& r, SceneFile& s, std::vector<Moved>& list, FreeBody body) {
  if (list.empty() || list.back().moved_by_input || list.back().free >= 0) r.fail("there is nothing before it that may be free");
  list.back().free = int(s.definition.free.size());
  body.mass = r.positive();
  for (double& moment : body.inertia) moment = r.positive();
  body.guide = r.vector();
  if (body.guided() && !(std::abs(body.guide.squaredNorm() - 1) < rounding)) r.fail("the guide is no unit vector");
  s.definition.free.push_back(body);
}
void read_free(Record& r, SceneFile& s) {
  if (!s.pins.empty()) r.fail("a free obstacle comes after a pin");
  if (!s.planes.empty() && !s.planes.back().solid()) r.fail("a plane is not free");
  make_free(r, s, s.planes, {.plane = int(s.planes.size()) - 1});
}
void read_pin_free(Record& r, SceneFile& s) { make_free(r, s, s.pins, {.pin = int(s.pins.size()) - 1}); }
bool is_pose(std::string_view kind, std::string_view word) {
  for (const FamilyInfo& info : families)
    for (char c : info.components)
      if (info.name.starts_with(kind) && !info.pose.empty() && word == std::string(info.pose) + "." + c) return true;
  return false;
}
/// Reads the inputs of the plane or pin of the record before.
template <class Moved>
void read_inputs(Record& r, std::vector<Moved>& list, std::string_view kind) {
  if (list.empty() || !list.back().moved_by_input) r.fail("there is nothing before it that inputs move");
  auto& inputs = list.back().inputs.emplace();
  while (r.more()) {
    const std::string_view word = r.word();
    if (!is_pose(kind, word)) r.fail("an unknown component of a pose");
    inputs.emplace(word);
  }
}
void read_load(Record& r, SceneFile& s) {
  SceneFile::Load load;
  load.name = r.word();
  load.points = r.points(count(s));
  if (load.points.empty()) r.fail("a load without points");
  s.loads.push_back(load);
}
/// Reads the outputs of the probe of the record before, beside its place.
void read_probe_outputs(Record& r, SceneFile& s) {
  if (s.probes.empty()) r.fail("there is no probe before it");
  SceneFile::Probe& probe = s.probes.back();
  const std::map<std::string_view, bool*> outputs{{"stress", &probe.stress},   {"von_mises", &probe.von_mises},
                                                  {"stretch", &probe.stretch}, {"velocity", &probe.velocity},
                                                  {"maximum", &probe.maximum}, {"acceleration", &probe.acceleration}};
  while (r.more()) *r.choice(outputs) = true;
  if ((probe.stress || probe.von_mises || probe.stretch) && !s.poissons_ratio) r.fail("there is no solid before it");
  if (!probe.maximum && !probe.acceleration) return;
  probe.followed = int(s.definition.sensed.followed.size());
  s.definition.sensed.followed.push_back({probe.at, probe.maximum, probe.von_mises && probe.maximum});
}
/// Reads the areas of the surface at each control point, or at each sample.
void read_areas(Record& r, SceneFile& s) {
  while (r.more()) s.definition.sensed.areas.push_back(r.vector());
}
void read_sensor(Record& r, SceneFile& s) {
  s.sensors.emplace_back(r.word());
  Patch& patch = s.definition.sensed.patches.emplace_back();
  while (r.more()) {
    patch.places.push_back(r.integer(0, int(s.definition.sensed.areas.size()) - 1));
    patch.weights.push_back(r.positive());
  }
  if (patch.places.empty()) r.fail("a sensor without places");
}
/// Reads the numbers of taxels of the sensor of the record before, and the fractions of places that belong to taxels.
void read_taxels(Record& r, SceneFile& s) {
  if (s.sensors.empty()) r.fail("there is no sensor before it");
  Patch& patch = s.definition.sensed.patches.back();
  for (int& n : patch.taxels) n = r.integer(1, most_taxels);
  for (int i = 0; i < patch.taxels[0]; ++i)
    for (int j = 0; j < patch.taxels[1]; ++j) s.taxels.push_back({int(s.sensors.size()) - 1, {i, j}});
  while (r.more()) {
    const int place = r.integer(0, int(s.definition.sensed.areas.size()) - 1), taxel = r.integer(0, patch.taxel_count() - 1);
    patch.fractions.push_back({place, taxel, r.at_least(0)});
  }
}
void read_initial(Record& r, SceneFile& s) {
  Definition& d = s.definition;
  d.stretch = r.vector();
  d.offset = r.vector();
  d.velocity = r.vector();
  d.angular_velocity = r.vector();
}
void read_stiffness(Record& r, SceneFile& s) {
  for (double* k : {&s.stiffness.edge, &s.stiffness.face, &s.stiffness.body}) *k = r.at_least(0);
}
/// Poisson's ratio makes the body a solid, whose points are the nodes of patches.
void read_poissons_ratio(Record& r, SceneFile& s) {
  s.poissons_ratio = r.at_least(0);
  const auto row = std::ranges::find(families, Family::poissons_ratio, &FamilyInfo::family);
  if (!(*s.poissons_ratio <= row->max)) r.fail("Poisson's ratio is above its largest value");
}
void read_basis(Record& r, SceneFile& s) {
  Basis& basis = s.definition.sensed.basis;
  basis = r.choice<Basis>({{"bezier", Basis::bezier}, {"bspline", Basis::bspline}, {"patches", Basis::patches}});
  s.definition.lattice.lobatto = basis == Basis::patches;
}
void read_modulus(Record& r, SceneFile& s) {
  s.modulus = r.positive();
  s.definition.of_modulus = true;
}

/// The keys of all records, and the functions that read them.
constexpr Reader readers[] = {
    {"guid", [](Record& r, SceneFile& s) { s.guid = r.word(); }},
    {"counts", read_counts},
    {"origin", [](Record& r, SceneFile& s) { s.definition.lattice.origin = r.vector(); }},
    {"size", read_size},
    {"topology",
     [](Record& r, SceneFile& s) {
       s.definition.topology = r.choice<Topology>({{"distinct", Topology::distinct}, {"paper", Topology::paper}});
     }},
    {"basis", read_basis},
    {"mass", read_mass},
    {"weight", read_weight},
    {"stiffness", read_stiffness},
    {"youngs_modulus", read_modulus},
    {"poissons_ratio", read_poissons_ratio},
    {"damping", [](Record& r, SceneFile& s) { s.damping = r.at_least(0); }},
    {"internal_damping", [](Record& r, SceneFile& s) { s.internal_damping = r.at_least(0); }},
    {"volume_stiffness", [](Record& r, SceneFile& s) { s.definition.volume_stiffness = r.positive(); }},
    {"gravity", [](Record& r, SceneFile& s) { s.gravity = r.vector(); }},
    {"region_stiffness", read_region<&Region::stiffness>},
    {"region_youngs_modulus", read_region<&Region::modulus>},
    {"region_damping", read_region<&Region::damping>},
    {"region_internal_damping", read_region<&Region::internal_damping>},
    {"plane", read_plane},
    {"plane_inputs", [](Record& r, SceneFile& s) { read_inputs(r, s.planes, "{obstacle}."); }},
    {"solid", read_solid},
    {"box", read_box},
    {"free", read_free},
    {"pin", read_pin},
    {"pin_origin", read_pin_origin},
    {"pin_start", read_pin_start},
    {"pin_free", read_pin_free},
    {"pin_inputs", [](Record& r, SceneFile& s) { read_inputs(r, s.pins, "pin."); }},
    {"load", read_load},
    {"probe",
     [](Record& r, SceneFile& s) {
       const std::string name(r.word());
       s.probes.push_back({name, r.vector()});
     }},
    {"probe_outputs", read_probe_outputs},
    {"areas", read_areas},
    {"sensor", read_sensor},
    {"sensor_taxels", read_taxels},
    {"sample", [](Record& r, SceneFile& s) { s.samples.push_back(r.vector()); }},
    {"forces", [](Record& r, SceneFile& s) { s.forces = r.points(count(s)); }},
    {"positions", [](Record& r, SceneFile& s) { s.positions = r.points(count(s)); }},
    {"velocities", [](Record& r, SceneFile& s) { s.velocities = r.points(count(s)); }},
    {"initial", read_initial},
    {"initial_rotation", [](Record& r, SceneFile& s) { s.rotation = r.vector(); }},
    {"spin_about_mass", [](Record&, SceneFile& s) { s.definition.spin_about_mass = true; }},
    {"flat_names", [](Record&, SceneFile& s) { s.flat_names = true; }},
    {"reactions", [](Record&, SceneFile& s) { s.reactions = true; }},
    {"energy", [](Record&, SceneFile& s) { s.energy = s.definition.watch_energy = true; }},
    {"solver", [](Record&, SceneFile& s) { s.solver = true; }},
    {"error_estimate", [](Record&, SceneFile& s) { s.error_estimate = true; }},
    {"stop_time", [](Record& r, SceneFile& s) { s.stop_time = r.positive(); }},
    {"method", [](Record& r, SceneFile& s) { s.method = r.integer(1, method_count); }},
    {"tolerance", [](Record& r, SceneFile& s) { s.tolerance = r.positive(); }},
    {"most_work", [](Record& r, SceneFile& s) { s.most_work = r.positive(); }},
    {"step", [](Record& r, SceneFile& s) { s.step = r.at_least(0); }},
    {"threads", [](Record& r, SceneFile& s) { s.threads = r.integer(1, 64); }},
};

/// Checks the first line and returns the text after it.
std::string_view checked_body(std::string_view text) {
  const std::size_t end = text.find('\n');
  Record head(text.substr(0, end), 1);
  if (end == text.npos || head.word() != "softffd-scene") head.fail("not a softffd scene");
  if (head.word() != "2") head.fail("another format version");
  const std::string_view body = text.substr(end + 1), digits = head.word();
  std::uint32_t wanted = 0;
  const auto [last, error] = std::from_chars(digits.data(), digits.data() + digits.size(), wanted, 16);
  if (error != std::errc() || last != digits.data() + digits.size() || wanted != crc32(body))
    head.fail("the checksum does not fit: the file is damaged");
  return body;
}

void check_solid(const SceneFile& s) {
  const auto refuse = [](const std::string& what) { throw SceneFileError("resources/scene.txt: " + what); };
  const bool solid = s.definition.solid();
  if (solid != s.poissons_ratio.has_value()) refuse("a solid, which has patches, has Poisson's ratio, and springs have neither");
  if (!solid) return;
  if (!s.modulus) refuse("a solid without youngs_modulus");
  for (const int n : s.definition.lattice.counts)
    if (!lobatto::whole(n)) refuse("a solid has 3 e + 1 points along each axis");
  if (s.definition.volume_stiffness > 0) refuse("a solid has no volume_stiffness");
  for (const Region& region : s.definition.regions)
    if (!region.damping) refuse("a region of a solid has damping alone");
  if (!takes_solid(Method(s.method - 1), s.definition.lattice))
    refuse("the method does not support this solid; wanted auto, leapfrog, bm4, rkn12 or dop853");
}

void check_complete(const SceneFile& s) {
  if (s.guid.empty()) throw SceneFileError("resources/scene.txt: the guid is missing");
  if (s.definition.mass.empty()) throw SceneFileError("resources/scene.txt: the masses are missing");
  if (s.modulus && s.definition.topology != Topology::distinct)
    throw SceneFileError("resources/scene.txt: springs of a modulus are of the topology distinct");
  check_solid(s);
  if (!s.definition.free.empty() && !takes_free_bodies(Method(s.method - 1)))
    throw SceneFileError("resources/scene.txt: the method does not support free bodies; wanted auto, leapfrog or sdirk2");
}

/// Distributes loads over their points: equally, or in a solid by the nodes' volume fractions, which make a uniform traction on a face.
void distribute_loads(SceneFile& s) {
  Scalars weights = Scalars::Ones(count(s));
  if (s.definition.solid()) weights = lobatto::volume_fractions(s.definition.lattice);
  for (SceneFile::Load& load : s.loads) {
    double sum = 0;
    for (const int p : load.points) sum += weights[p];
    for (const int p : load.points) load.weights.push_back(weights[p] / sum);
  }
}

/// Makes planes meet the samples of the surface, if there are any.
void take_samples(SceneFile& s) {
  const auto refuse = [](const std::string& what) { throw SceneFileError("resources/scene.txt: " + what); };
  const auto solid = [](const PlaneMotion& plane) { return plane.solid(); };
  const bool solids = std::ranges::any_of(s.planes, solid);
  if (solids && s.samples.empty()) refuse("solids need samples of the surface, and there are none");
  if (!std::ranges::is_partitioned(s.planes, std::not_fn(solid))) refuse("a plane comes after a solid");
  if (s.samples.empty() || s.planes.empty()) return;
  Definition& d = s.definition;
  d.solids = solids;
  for (const Vec3& place : s.samples) {
    const auto part = (place - d.lattice.origin).array() / d.lattice.size.array();
    if (!(part.minCoeff() >= -outside && part.maxCoeff() <= 1 + outside)) refuse("a sample of the surface lies outside of the box");
  }
  if (!meets_surface(Method(s.method - 1)))
    refuse(
        "the method does not support contact of the surface; wanted auto, leapfrog, bm4, rkn12, dop853, ros34pw2, backward_euler or "
        "sdirk2");
  d.samples = std::make_shared<const Samples>(d.sensed.basis, d.lattice, s.samples);
}

void check_sensors(const SceneFile& s) {
  const Definition& d = s.definition;
  const std::size_t places = d.samples ? s.samples.size() : std::size_t(count(s));
  if (!s.sensors.empty() && (d.planes == 0 || d.sensed.areas.size() != places))
    throw SceneFileError("resources/scene.txt: sensors need an obstacle, and an area of the surface for each place that may touch it");
}

}  // namespace

SceneFile parse_scene(std::string_view text) {
  std::string_view body = checked_body(text);
  SceneFile scene;
  for (int number = 2; !body.empty(); ++number) {
    const std::size_t end = std::min(body.find('\n'), body.size());
    Record record(body.substr(0, end), number);
    body.remove_prefix(std::min(end + 1, body.size()));
    const std::string_view key = record.word();
    const auto reader = std::find_if(std::begin(readers), std::end(readers), [&](const Reader& r) { return r.key == key; });
    if (reader == std::end(readers)) record.fail("an unknown record");
    reader->read(record, scene);
    if (record.more()) record.fail("more values than the record takes");
  }
  check_complete(scene);
  distribute_loads(scene);
  take_samples(scene);
  check_sensors(scene);
  return scene;
}

SceneFile read_scene(const std::string& path) {
#ifdef _WIN32
  std::FILE* file = _wfopen(std::filesystem::path(std::u8string(path.begin(), path.end())).c_str(), L"rb");
#else
  std::FILE* file = std::fopen(path.c_str(), "rb");
#endif
  if (!file) throw SceneFileError("cannot read " + path);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> closed(file, std::fclose);
  std::string text;
  std::array<char, 16384> piece;
  while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), file)) text.append(piece.data(), count);
  if (std::ferror(file)) throw SceneFileError("cannot read " + path);
  return parse_scene(text);
}

}  // namespace softffd::fmi
