/// How long a body that pins hold remembers what moves it, by its slowest vibrations.
#pragma once
#include "body/body.hpp"

namespace softffd {

/// Time in which its damping takes 1 / e of a pinned body's slowest vibration about the rest shape, or of its creep [s]; `longest` if it is
/// longer, as it is without damping. Inverse iteration from uniform motion along each axis: a frequency by Rayleigh's quotient, a little
/// too high.
double memory_of_slowest_vibration(const Lattice& lattice, const Body& body, double longest);

}  // namespace softffd
