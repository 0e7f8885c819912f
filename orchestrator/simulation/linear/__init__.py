"""Scenarios as linear systems about a state, identified through the interfaces of their FMUs."""
