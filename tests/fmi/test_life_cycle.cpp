/// The C interface driven as a host drives it; meant for sanitizers above all.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

extern "C" {
#include "fmi2Functions.h"
}

#include "check.hpp"

namespace {

std::string write_scene() {
  std::string body = "guid {g}\ncounts 4 4 4\nmass";
  for (int p = 0; p < 64; ++p) body += " 0.015625";
  body += "\nstiffness 1000 1000 1000\ndamping 0.01\ngravity 0 0 -9.81\nplane ground fixed 0 0 0 0 0 1 0 0 0 0 0 0 0.4\npositions";
  for (int p = 0; p < 64; ++p) body.append(" ").append(std::to_string(p));
  body += "\ninitial 1 1 1 0 0 0.1 1 0 0 0 0 0\nreactions\nenergy\nsolver\n";
  std::uint64_t hash = 14695981039346656037u;
  for (unsigned char c : body) hash = (hash ^ c) * 1099511628211u;
  char head[64];
  std::snprintf(head, sizeof head, "softffd-scene 1 %016llx\n", static_cast<unsigned long long>(hash));
  const auto folder = std::filesystem::temp_directory_path() / ("softffd test %" + std::to_string(std::rand()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "scene.txt", std::ios::binary) << head << body;
  return folder.string();
}

std::string uri_of(const std::string& path) {
  std::string uri = "file://";
  for (char c : path) uri += c == ' ' ? "%20" : c == '%' ? "%25" : std::string(1, c);
  return uri;
}

const std::string& resources() {
  static const std::string uri = uri_of(write_scene());
  return uri;
}

fmi2Component instantiate(const char* guid = "{g}") {
  fmi2CallbackFunctions callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
  return fmi2Instantiate("box", fmi2CoSimulation, guid, resources().c_str(), &callbacks, fmi2False, fmi2False);
}

std::vector<double> run(fmi2Component c, int steps) {
  CHECK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0) == fmi2OK);
  CHECK(fmi2EnterInitializationMode(c) == fmi2OK);
  CHECK(fmi2ExitInitializationMode(c) == fmi2OK);
  for (int i = 0; i < steps; ++i) CHECK(fmi2DoStep(c, i * 0.01, 0.01, fmi2True) == fmi2OK);
  std::vector<fmi2ValueReference> references(192);
  for (unsigned i = 0; i < 192; ++i) references[i] = 60u << 24 | i;
  std::vector<double> positions(192);
  CHECK(fmi2GetReal(c, references.data(), 192, positions.data()) == fmi2OK);
  return positions;
}

}  // namespace

TEST(threads_and_resets_give_the_same_bits) {
  fmi2Component one = instantiate();
  CHECK(one != nullptr);
  const std::vector<double> expected = run(one, 50);
  CHECK(fmi2Reset(one) == fmi2OK);
  CHECK(run(one, 50) == expected);
  fmi2FreeInstance(one);
  std::vector<std::vector<double>> results(4);
  std::vector<std::thread> threads;
  for (auto& result : results)
    threads.emplace_back([&result] {
      fmi2Component c = instantiate();
      result = run(c, 50);
      fmi2FreeInstance(c);
    });
  for (auto& thread : threads) thread.join();
  for (const auto& result : results) CHECK(result == expected);
}

TEST(calls_in_the_wrong_state_or_on_dead_handles_are_errors) {
  CHECK(fmi2DoStep(nullptr, 0, 1, fmi2True) == fmi2Error);
  fmi2Component c = instantiate();
  CHECK(fmi2DoStep(c, 0, 0.01, fmi2True) == fmi2Error);
  CHECK(fmi2Reset(c) == fmi2OK);
  run(c, 1);
  fmi2FreeInstance(c);
  CHECK(fmi2DoStep(c, 0.01, 0.01, fmi2True) == fmi2Error);
  fmi2FreeInstance(c);
  CHECK(instantiate("{another}") == nullptr);
}

TEST(a_refused_value_changes_nothing) {
  fmi2Component c = instantiate();
  const fmi2ValueReference references[] = {26u << 24, 25u << 24};
  const double values[] = {5.0, -1.0};
  CHECK(fmi2SetReal(c, references, 2, values) == fmi2Error);
  CHECK(fmi2Reset(c) == fmi2OK);
  CHECK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0) == fmi2OK);
  CHECK(fmi2EnterInitializationMode(c) == fmi2OK);
  double stiffness = 0;
  CHECK(fmi2GetReal(c, references, 1, &stiffness) == fmi2OK);
  CHECK(stiffness == 1000.0);
  fmi2FreeInstance(c);
}

TEST(hundreds_of_instances_come_and_go) {
  for (int i = 0; i < 300; ++i) fmi2FreeInstance(instantiate());
}
