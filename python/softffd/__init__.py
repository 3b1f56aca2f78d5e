"""softffd: a soft object (mass-spring Bezier free-form deformation) as an FMI 2.0 co-simulation component."""

__version__ = "0.1.0"
