"""Studies: many runs of a scene, and what they say together."""
