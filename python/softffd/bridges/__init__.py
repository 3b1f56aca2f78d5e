"""Soft bodies in the loops of physics engines: `coupled` is the same for all, beside it is a module for each engine."""
