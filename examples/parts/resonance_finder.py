"""A controller: drives the electrode that pushes along the motion, so that the motion grows.

The push is in phase with the velocity, which is so at the resonance alone. The command goes over
smoothly where the velocity is below `threshold`, and is cut to between zero and `amplitude`.
"""

from math import tanh

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class ResonanceFinder(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.amplitude = 1000.0
        self.threshold = 0.01
        self.velocity = 0.0
        self.top = self.bottom = 0.0
        for name in ("amplitude", "threshold"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter))
        self.register_variable(Real("velocity", causality=Fmi2Causality.input))
        for name in ("top", "bottom"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        along = tanh((self.velocity + 1e-3) / self.threshold)  # leans to one side: the first push
        self.top = self.amplitude * max(0.0, along)
        self.bottom = self.amplitude * max(0.0, -along)
        return True
