"""The paper's dynamic simplification of the actuator: a linear spring with a V^2 force."""
