"""A mesh in the lattice: weights, deformation, masses."""
