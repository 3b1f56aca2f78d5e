"""Small scenes that the tests of the measurement run, and what they read of its files."""

import csv
from pathlib import Path

SMALL = """
title = "A small box"
[lattice]
points = [2, 2, 2]
[material]
stiffness = 1e3
damping = 0.0
[initial]
stretch = [1.1, 1.0, 1.0]
[experiment]
stop_time = 0.05
communication_step = 0.01
"""

DRIVEN = """
[lattice]
points = [3, 2, 2]
size = [1.0, 0.5, 0.7]
springs = "paper"
[material]
stiffness = { edge = 1e3, face = 500.0, body = 200.0 }
damping = 0.05
[[region]]
points = "x-"
stiffness = 4e3
mass = 0.3
damping = 0.2
[environment]
gravity = [0.5, 0.0, -9.81]
[[load]]
name = "push"
points = "x+"
[inputs]
forces = [[1, 1, 0]]
[initial]
stretch = [1.1, 0.95, 1.0]
velocity = [0.0, 0.3, 0.0]
angular_velocity = [1.0, 0.0, 2.0]
[experiment]
stop_time = 0.2
communication_step = 0.02
"""

RUBBER = """
title = "A rubber block that slides"
[lattice]
points = [3, 3, 3]
size = [0.1, 0.1, 0.1]
origin = [0.0, 0.0, 0.0]
[mass]
total = 0.5
[material]
stiffness = 1e4
damping = 0.0
internal_damping = 3e-3
[environment]
gravity = [5.0, 0.0, -9.81]
[[plane]]
name = "ground"
friction = 0.3
[experiment]
stop_time = 0.04
communication_step = 0.01
"""
COURSE = 'time,load.push.x,"force[1,1,0].z"\n0,0,0\n0.1,6,-2\n0.14,6,1\n0.2,6,0\n'


def table_rows() -> list[dict[str, str]]:
    return list(csv.DictReader(Path("out/accuracy.csv").read_text().splitlines()))
