"""A mass that lies on a soft body, along one axis: a partner FMU to copy. pythonfmu build -f mass.py makes Mass.fmu."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

GRAVITY = -9.81


class Mass(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.mass, self.reaction, self.point, self.velocity = 5.0, 0.0, 0.0, 0.0
        self.register_variable(Real("mass", causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed))
        for name, causality in (("reaction", "input"), ("point", "output"), ("velocity", "output")):
            self.register_variable(Real(name, causality=Fmi2Causality[causality]))
        self.place = self.speed = self.middle = self.step = 0.0  # of the mass; of the plane in the step whose reaction is to arrive
        self.seen, self.products, self.squares = (0.0, 0.0), 0.0, 0.0  # middle and reaction of the step before that; of the secant

    def moved(self, place, speed, force, time):
        acceleration = force / self.mass + GRAVITY
        return place + time * (speed + time / 2 * acceleration), speed + time * acceleration

    def do_step(self, current_time, step_size):
        # through the last step with the reaction that arrived, which is of that step
        self.place, self.speed = self.moved(self.place, self.speed, self.reaction, self.step)
        # the body's stiffness, by the changes of reaction and place while it pushes
        if self.reaction and self.seen[1]:
            way = self.middle - self.seen[0]
            self.products = 0.8 * self.products - way * (self.reaction - self.seen[1])
            self.squares = 0.8 * self.squares + way * way
        stiffness = max(0.0, self.products / self.squares) if self.reaction and self.squares else 0.0
        # through this step, which the body does meanwhile, with the reaction expected of it
        middle = self.point + step_size / 2 * self.velocity
        expected = self.reaction - stiffness * (middle - self.middle)
        place, speed = self.moved(self.place, self.speed, expected, step_size)
        self.seen, self.middle, self.step = (self.middle, self.reaction), middle, step_size
        # the mean velocity over the next step, by the implicit midpoint rule
        expected -= stiffness * (place - middle)
        ahead = speed + step_size / 2 * (expected / self.mass + GRAVITY)
        self.point, self.velocity = place, ahead / (1 + stiffness * step_size**2 / 4 / self.mass)
        return True
