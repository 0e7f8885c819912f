"""The diagram of a scenario: laid out, then drawn."""
