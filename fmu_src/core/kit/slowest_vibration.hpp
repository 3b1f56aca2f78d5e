/// How long a body that pins hold remembers what moves it, by its slowest vibrations.
#pragma once
#include <memory>

#include "body/body.hpp"
#include "matrix/lattice_matrix.hpp"

namespace softffd {

class SlowestVibration {
 public:
  explicit SlowestVibration(const Lattice& lattice) : lattice_(lattice) {}

  /// Time in which its damping takes 1 / e of a pinned body's slowest vibration about the rest shape, or of its creep [s]; `longest` if it
  /// is longer, as it is without damping. Inverse iteration from uniform motion along each axis, for each version of the body once: a
  /// frequency by Rayleigh's quotient, a little too high.
  double memory(const Body& body, double longest);

 private:
  struct Room {
    explicit Room(const Lattice& lattice);
    Points rest, mode, force;
    Scalars diagonal;
    LatticeMatrix matrix;
  };
  double find(const Body& body, double longest);

  Lattice lattice_;
  std::unique_ptr<Room> room_;  ///< made when it is first asked for
  double memory_ = 0, longest_ = 0;
  Count version_ = -1;
};

}  // namespace softffd
