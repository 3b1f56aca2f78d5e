"""A prescribed load and a prescribed motion: source of a driver FMU.

Both follow one course s(t): a sine of amplitude 1 (course = 1), or a smooth step from 0 to 1 (course = 2, 6 q^5 - 15 q^4 + 10 q^3,
acceleration without jumps). The course begins at `start` and has the period or rise time `duration`.

    force     = load * s            connects with load.<name> of a scene, or with the plate's `force`
    position  = rest + travel * s   connects with pin.<name>.position; `rest` is where the pin's frame is at rest
    velocity                        connects with pin.<name>.velocity

A master holds or continues the outputs of a communication point over the step that follows. `velocity` is therefore the mean velocity over
a next step as long as the last (the pose then does not jump), and `force` the value in the middle of that step. `position` is exact.
"""

from math import pi, sin

from softffd_driver import Driver
from softffd_pythonfmu import mend

ZERO = (0.0, 0.0, 0.0)


class Actuator(Driver):
    description = "A prescribed load and a prescribed motion: a sine or a smooth step"
    table = (
        ("course", "parameter", None, 1, "Course over time: 1 sine, 2 smooth step"),
        ("start", "parameter", "s", 0.0, "Time at which it begins"),
        ("duration", "parameter", "s", 1.0, "Period of the sine or rise time of the step, above 0"),
        ("load", "parameter", "N", ZERO, "Force where the course is 1"),
        ("travel", "parameter", "m", ZERO, "Displacement where the course is 1"),
        ("rest", "parameter", "m", ZERO, "Position where the course is 0"),
        ("force", "output", "N", ZERO, "Force in the middle of the next step"),
        ("position", "output", "m", ZERO, "Position at the communication point"),
        ("velocity", "output", "m/s", ZERO, "Mean velocity over the next step"),
    )

    def begin(self) -> None:
        self._put_out(self.values.get("time", 0.0), 1e-6 * self.values["duration"])

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        self.values["time"] = start_time
        self.begin()

    def exit_initialization_mode(self) -> None:
        if not self.values["duration"] > 0:
            raise ValueError(f"duration: wanted > 0 s, got {self.values['duration']:g}")
        if self.values["course"] not in (1, 2):
            raise ValueError(f"course: wanted 1 (sine) or 2 (smooth step), got {self.values['course']}")

    def do_step(self, current_time: float, step_size: float) -> bool:
        self.values["steps"] += 1
        self._put_out(current_time + step_size, step_size)
        return True

    def _course(self, time: float) -> float:
        share = (time - self.values["start"]) / (self.values["duration"] or 1.0)
        if share <= 0:
            return 0.0
        if self.values["course"] == 1:
            return sin(2 * pi * share)
        return 1.0 if share >= 1 else share**3 * (share * (6 * share - 15) + 10)

    def _put_out(self, time: float, ahead: float) -> None:
        values = self.values
        now, middle, later = (self._course(time + part * ahead) for part in (0.0, 0.5, 1.0))
        for i in range(3):
            values["force"][i] = values["load"][i] * middle
            values["position"][i] = values["rest"][i] + values["travel"][i] * now
            values["velocity"][i] = values["travel"][i] * (later - now) / (ahead or 1.0)


mend(globals())
