"""Bodies with a surface: those of the surveys."""

from softffd.validation.bodies import cube, sphere, write

__all__ = ["cube", "sphere", "write"]
