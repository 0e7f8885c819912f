"""A recording as a part: columns over time become outputs, with the laws that follow from them."""
