"""A spring of 1 between two masses: its forces follow the displacements directly."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class CouplingSpring(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.left = 0.0
        self.right = 0.0
        for name in ("left", "right"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("force_on_left", "force_on_right"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    @property
    def force_on_left(self):
        return self.right - self.left

    @property
    def force_on_right(self):
        return self.left - self.right

    def do_step(self, current_time, step_size):
        return True
