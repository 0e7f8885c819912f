"""The paper's figures and tables from runs: its numbers, ours, and what ours rest on."""
