"""A mass on a spring to the ground, both of 1, driven by a force that is held over a step."""

from math import cos, sin

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Mass(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.start_displacement = 1.0
        self.force = 0.0
        self.displacement = 0.0
        self.velocity = 0.0
        self.register_variable(Real("start_displacement", causality=Fmi2Causality.parameter))
        self.register_variable(Real("force", causality=Fmi2Causality.input))
        self.register_variable(Real("displacement", causality=Fmi2Causality.output))
        self.register_variable(Real("velocity", causality=Fmi2Causality.output))

    def enter_initialization_mode(self):
        self.displacement = self.start_displacement

    def do_step(self, current_time, step_size):
        """x'' = force - x for a constant force: a rotation about the point of rest."""
        c, s = cos(step_size), sin(step_size)
        x, v = self.displacement - self.force, self.velocity
        self.displacement = self.force + x * c + v * s
        self.velocity = v * c - x * s
        return True
