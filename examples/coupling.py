"""A rigid plate of 5 kg falls on a soft box and rests there: pose in, reaction out, one after the other.

Run it where the README's box.toml lies.
"""

import softffd

H, MASS, GRAVITY = 1e-3, 5.0, -9.81
z, v, force = 0.2, 0.0, 0.0

with softffd.Simulation(softffd.load_scene("box.toml"), stop_time=4.0) as box:
    moved = box.block(["plane.plate.point.z", "plane.plate.velocity.z"])
    pressed = box.block(["plane.plate.reaction.z"])
    for _ in range(4000):
        mean = v + H / 2 * (force / MASS + GRAVITY)  # the plate's velocity over the step, by the last force
        moved.set((z, mean))  # where the plate is and how it moves during the step
        box.step(H)
        force = pressed.get()[0]  # mean force of the box on the plate
        z, v = z + H * mean, v + H * (force / MASS + GRAVITY)

print(f"the plate rests at {z:.3f} m and presses with {force:.2f} N")
