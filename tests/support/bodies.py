"""Bodies with a surface: those of the surveys."""

from validation.shapes import cube, sphere, write

__all__ = ["cube", "sphere", "write"]
