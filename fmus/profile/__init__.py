"""Shape of both cones, for pictures and for what needs room around them."""
