"""Parts without Python: from the same physics source to C, and from there to a shared library.

`translate` makes C of a physics module, `semantics.h` has what Python does where C does otherwise,
`table` and `layer.c` the FMI 2 functions around it, `link` the shared libraries, `package` the FMU
and `reference` the right-hand side of the monolith. Nothing else imports this.
"""
