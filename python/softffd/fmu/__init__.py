"""From a scene to an FMU, and an FMU opened."""
