"""A mass on the spacer of the actuator."""
