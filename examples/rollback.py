"""A plate of 50 g, pressed on a soft box with 20 N: lighter than what it touches, so that each step is tried again until both agree.

The force of the box on the plate and the plate's motion depend on each other; the one that fits is found by halving an interval, each time
from the same saved state. Run it where the README's box.toml lies.
"""

import softffd

H, MASS, LOAD, GRAVITY = 1e-3, 0.05, 20.0, -9.81
z, v = 0.0, 0.0

with softffd.Simulation(softffd.load_scene("box.toml")) as box:
    plate = box.plane["plate"]

    def attempt(force):
        """The plate's velocity after a step under this force of the box, and by how much the box's answer exceeds it."""
        box.restore(before)
        after = v + H * ((force - LOAD) / MASS + GRAVITY)
        plate.point, plate.velocity = (0, 0, z), (0, 0, (v + after) / 2)
        box.step(H)
        return after, plate.reaction[2] - force

    for _ in range(500):
        before = box.save()
        low, high = 0.0, attempt(0.0)[1]
        while high - low > 1e-6:  # the answer falls where the force grows
            force = (low + high) / 2
            low, high = (force, high) if attempt(force)[1] > 0 else (low, force)
        after, _ = attempt(high)
        z, v = z + H * (v + after) / 2, after

print(f"the light plate rests at {z:.4f} m and is held by {high:.2f} N")
