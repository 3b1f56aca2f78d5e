"""A rigid plate with mass that a soft body pushes and that pushes back: source of a driver FMU.

The plate moves without turning. Its outputs connect name to name with an obstacle plane of the scene (`point`, `normal`, `velocity`), and
the plane's `reaction` is its input. The reaction is the body's impulse of the communication step just done, divided by the length of the
step; the plate takes exactly that impulse. The time at which it takes the impulse depends on the master (parameter `delay`):

    delay = 1   All components step, then values are exchanged (Jacobi). The reaction that arrives at t_n belongs to the step before, and
                the plate has gone through that step with a predicted force. It returns to the start of that step, repeats the step with
                the impulse that arrived, and goes on through the coming step with a new prediction:

                      with the impulse that arrived         with the predicted force
                      t_(n-1) ----------------------> t_n ---------------------------------> t_(n+1): point and velocity put out

                Prediction errors do not add up: `momentum` holds every impulse that arrived and no prediction.
    delay = 0   The reaction that is set belongs to the step that is about to be done: masters that step the body first, or iterate.

The prediction treats the body as a spring. The predicted force is the reaction that arrived, less the stiffness times the distance from
the middle of that step to the middle of the predicted one. The stiffness, one for each axis, is a least-squares secant of the changes of
force over these distances; a step has 0.8 of the weight of the next. The stiffness is never negative, and it is learnt and used only while
the body pushes.

`velocity` is the mean velocity over a following step of the same length. On a spring, velocity and force then satisfy the implicit
midpoint rule, which keeps the energy at any step: the coupling neither excites nor damps a contact of frequency omega (rad/s, of the plate
on the body's stiffness). A force held over the step would excite or damp the contact by (step * omega)^3 / 8 a radian.

Balance at every exchange, to rounding: momentum (as put out) + momentum of the body + step length * reaction (delay = 1: this impulse is
under way) = momentum at the start + impulse of weight and of other forces. With delay = 1 `momentum` is that at the start of the step done
last.

Limits. During a step the plane acts on the body as if its mass were infinite. The plate should weigh five times the control points that it
touches (three times if the master steps the body first); below, contact chatters. step * omega should be at most 1. The velocity jump
between two steps costs energy of the body's mass that moves along: up to step * omega / 2 times the mass ratio of body to plate per
radian. A lighter plate needs a master that iterates (delay = 0; FMU states of the plate can be saved and restored).
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
        ("delay", "parameter", None, 1, "Delay of the reaction in communication steps: 1 or 0"),
        ("point", "output", "m", ZERO, "Point of the plate's surface at the communication point"),
        ("normal", "output", "1", ZERO, "Normal of the surface, out of the plate towards the body"),
        ("velocity", "output", "m/s", ZERO, "Mean velocity over the next step"),
        ("momentum", "output", "N.s", ZERO, "Momentum by the impulses that have arrived"),
    )

    def begin(self) -> None:
        values = self.values
        for name in ("point", "velocity", "normal"):
            values[name] = list(values[f"initial.{name}"])
        values["true_point"], values["true_velocity"] = list(values["point"]), list(values["velocity"])
        values["momentum"] = [values["mass"] * speed for speed in values["velocity"]]
        values["last_step"], values["last_force"] = 0.0, list(ZERO)
        values["middle"] = list(values["point"])
        values["seen"] = [[place, 0.0, 0.0, 0.0] for place in values["point"]]

    def exit_initialization_mode(self) -> None:
        if not self.values["mass"] > 0:
            raise ValueError(f"mass: wanted > 0 kg, got {self.values['mass']:g}")
        if self.values["delay"] not in (0, 1):
            raise ValueError(f"delay: wanted 0 or 1, got {self.values['delay']}")

    def do_step(self, current_time: float, step_size: float) -> bool:
        for axis in range(3):
            self._step_axis(axis, step_size)
        self.values["last_step"], self.values["last_force"] = step_size, list(self.values["force"])
        self.values["steps"] += 1
        return True

    def _step_axis(self, i: int, step: float) -> None:
        values, mass = self.values, self.values["mass"]
        place, speed, reaction, other = values["true_point"][i], values["true_velocity"][i], values["reaction"][i], values["force"][i]
        middle = known = values["point"][i] + 0.5 * step * values["velocity"][i]
        if values["delay"] == 1:
            known, values["middle"][i] = values["middle"][i], middle
            place, speed = self._moved(i, place, speed, reaction + values["last_force"][i], values["last_step"])
            values["true_point"][i], values["true_velocity"][i] = place, speed
        stiffness = self._stiffness(i, known, reaction)
        reaction -= stiffness * (middle - known)
        place, speed = self._moved(i, place, speed, reaction + other, step)
        if values["delay"] == 0:
            values["true_point"][i], values["true_velocity"][i] = place, speed
        reaction -= stiffness * (place - middle)  # the prediction for the coming step, without the plate's displacement in it
        ahead = speed + 0.5 * step * (values["gravity"][i] + (reaction + other) / mass)
        values["point"][i], values["velocity"][i] = place, ahead / (1 + 0.25 * step * step * stiffness / mass)
        values["momentum"][i] = mass * values["true_velocity"][i]

    def _stiffness(self, i: int, middle: float, reaction: float) -> float:
        """Returns the body's stiffness [N/m] along axis i after a step with this reaction [N] and with the plane at `middle` [m]
        halfway."""
        last_middle, last_reaction, products, squares = self.values["seen"][i]
        if reaction and last_reaction:
            way = middle - last_middle
            products = 0.8 * products - way * (reaction - last_reaction)
            squares = 0.8 * squares + way * way
        self.values["seen"][i] = [middle, reaction, products, squares]
        return max(0.0, products / squares) if reaction and squares > 1e-300 else 0.0

    def _moved(self, i: int, place: float, speed: float, force: float, time: float) -> tuple[float, float]:
        """Returns component i of place [m] and velocity [m/s] after `time` [s] under a constant force [N] and gravity."""
        acceleration = self.values["gravity"][i] + force / self.values["mass"]
        after = speed + time * acceleration
        return place + 0.5 * time * (speed + after), after


mend(globals())
