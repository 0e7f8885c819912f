"""The communication loop in C, laid over the arrays of a system: bitwise what the Python loop does.

`loop.h` describes the structures and why the loop returns; `library` compiles it once for this
machine, `layout` fills the structures in, `drive` runs it and does in Python what is rare.
"""
