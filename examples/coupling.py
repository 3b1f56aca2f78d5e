"""A rigid plate of 5 kg falls on a soft box and rests there: pose in, reaction out, each step tried until both fit.

Run it where the README's box.toml lies.
"""

import softffd

H, MASS, GRAVITY = 1e-3, 5.0, -9.81
z, v, force, give = 0.2, 0.0, 0.0, 0.0

with softffd.Simulation(softffd.load_scene("box.toml"), stop_time=4.0) as box:
    moved = box.block(["plane.plate.point.z", "plane.plate.velocity.z"])
    pressed = box.block(["plane.plate.reaction.z"])

    def answer(velocity: float) -> float:
        """Mean force of the box on the plate over a step in which it moves from z on at this velocity."""
        box.restore(before)
        moved.set((z, velocity))
        box.step(H)
        return float(pressed.get()[0])

    for _ in range(4000):
        before, mean = box.save(), v + H / 2 * (force / MASS + GRAVITY)  # the velocity over the step, by the last force
        force = answer(mean)
        for _ in range(8):  # until motion and force fit
            off = v + H / 2 * (force / MASS + GRAVITY) - mean
            if abs(off) < 1e-9:
                break
            last, mean = (mean, force), mean + off / (1 + H / 2 * give / MASS)
            force = answer(mean)
            give = max(0.0, (last[1] - force) / (mean - last[0]))  # by how much the force falls where the velocity grows
        z, v = z + H * mean, v + H * (force / MASS + GRAVITY)

print(f"the plate rests at {z:.3f} m and presses with {force:.2f} N")
