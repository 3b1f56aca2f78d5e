"""A mesh in the lattice: its weights, its deformation, its masses."""
