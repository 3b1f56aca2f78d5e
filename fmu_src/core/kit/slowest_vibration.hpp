/// How long a body that pins hold remembers a disturbance, by its slowest vibrations.
#pragma once
#include <memory>

#include "body/body.hpp"
#include "matrix/lattice_matrix.hpp"

namespace softffd {

class SlowestVibration {
 public:
  explicit SlowestVibration(const Lattice& lattice) : lattice_(lattice) {}

  /// Time in which damping takes the slowest vibration of a pinned body about the rest shape, or its creep, to 1 / e [s]; `longest` if that
  /// time is longer, as without damping. Inverse iteration from uniform motion along each axis, once for each version of the body; the
  /// frequency is a Rayleigh quotient, a little too high.
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
