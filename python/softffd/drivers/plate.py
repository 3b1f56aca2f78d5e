"""A rigid plate with mass that a soft body pushes and that pushes back: source of a driver FMU.

The plate moves without turning. What leaves it connects name to name with an obstacle plane of the scene (`point`, `normal`, `velocity`),
and the plane's `reaction` comes back. The reaction is the body's impulse of the communication step just done, divided by its length; the
plate takes exactly that impulse. Where it takes it depends on the master (parameter `delay`):

    delay = 1   All components step, then values are exchanged (Jacobi). What arrives at t_n belongs to the step before, and the plate has
                gone through that step on a guess: the impulse of one step earlier. It returns to the start of that step, goes through it
                with the impulse that was, and from there through the coming step on the new guess:

                      with the impulse that arrived         with the same force once more
                      t_(n-1) ----------------------> t_n ---------------------------------> t_(n+1): point and velocity put out

                Guesses do not add up: the motion put out is wrong by the third order of the step, and `momentum` holds every impulse
                that arrived and no guess.
    delay = 0   The reaction that is set belongs to the step that is about to be done: masters that step the body first, or iterate.

`velocity` is the mean velocity that the plate expects over a following step of the same length: with it the plane ends where the plate is
going to be, so poses do not jump, and the energy error of the coupling falls with the square of the communication step.

Balance at every exchange, to rounding: momentum (as put out) + momentum of the body + step length * reaction (delay = 1: it is under
way) = momentum at the start + impulse of weight and of other forces. With delay = 1 `momentum` is that at the start of the step done last.

Limits of an explicit coupling. A contact of frequency omega (rad/s, of the plate on the body's stiffness) needs step * omega < 0.67. And to
the body the plane is as heavy as anything during a step: the plate should weigh four times the control points that it touches or more; at
twice their weight it chatters, below their weight it diverges. A lighter one needs a master that iterates (delay = 0; the plate gives and
takes FMU states).
"""

from softffd_driver import Driver
from softffd_pythonfmu import mend

ZERO = (0.0, 0.0, 0.0)


class Plate(Driver):
    description = "A rigid plate with mass that a soft body pushes and that pushes back"
    table = (
        ("reaction", "input", "N", ZERO, "Mean force of the body on the plate over one communication step"),
        ("force", "input", "N", ZERO, "Any other force on the plate, held over the step"),
        ("mass", "parameter", "kg", 5.0, "Mass, above 0"),
        ("gravity", "parameter", "m/s2", (0.0, 0.0, -9.81), "Acceleration of gravity"),
        ("initial.point", "parameter", "m", ZERO, "Point of the plate's surface at the start"),
        ("initial.velocity", "parameter", "m/s", ZERO, "Velocity at the start"),
        ("initial.normal", "parameter", "1", (0.0, 0.0, -1.0), "Normal of the surface, out of the plate towards the body"),
        ("delay", "parameter", None, 1, "Communication steps by which the reaction is late: 1 or 0"),
        ("point", "output", "m", ZERO, "Point of the plate's surface at the communication point"),
        ("normal", "output", "1", ZERO, "Normal of the surface, out of the plate towards the body"),
        ("velocity", "output", "m/s", ZERO, "Mean velocity over the next step"),
        ("momentum", "output", "N.s", ZERO, "Momentum by the impulses that have arrived"),
    )

    def begin(self):
        values = self.values
        for name in ("point", "velocity", "normal"):
            values[name] = list(values[f"initial.{name}"])
        values["true_point"], values["true_velocity"] = list(values["point"]), list(values["velocity"])
        values["momentum"] = [values["mass"] * speed for speed in values["velocity"]]
        values["last_step"], values["last_force"] = 0.0, list(ZERO)

    def exit_initialization_mode(self):
        if not self.values["mass"] > 0:
            raise ValueError(f"mass: wanted > 0 kg, got {self.values['mass']:g}")
        if self.values["delay"] not in (0, 1):
            raise ValueError(f"delay: wanted 0 or 1, got {self.values['delay']}")

    def do_step(self, current_time, step_size):
        for axis in range(3):
            self._step_axis(axis, step_size)
        self.values["last_step"], self.values["last_force"] = step_size, list(self.values["force"])
        self.values["steps"] += 1
        return True

    def _step_axis(self, i, step):
        values = self.values
        place, speed, reaction = values["true_point"][i], values["true_velocity"][i], values["reaction"][i]
        if values["delay"] == 1:
            place, speed, _ = self._moved(i, place, speed, reaction + values["last_force"][i], values["last_step"])
            values["true_point"][i], values["true_velocity"][i] = place, speed
        place, speed, acceleration = self._moved(i, place, speed, reaction + values["force"][i], step)
        if values["delay"] == 0:
            values["true_point"][i], values["true_velocity"][i] = place, speed
        values["point"][i], values["velocity"][i] = place, speed + 0.5 * step * acceleration
        values["momentum"][i] = values["mass"] * values["true_velocity"][i]

    def _moved(self, i, place, speed, force, time):
        """Component i of place [m], velocity [m/s] and acceleration after `time` [s] under a constant force [N] and gravity."""
        acceleration = self.values["gravity"][i] + force / self.values["mass"]
        after = speed + time * acceleration
        return place + 0.5 * time * (speed + after), after, acceleration


mend(globals())
