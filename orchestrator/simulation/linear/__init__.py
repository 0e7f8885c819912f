"""Scenarios as linear systems about a state, identified through their FMI interfaces."""
