"""Parts without Python: from the same physics source to C, and from there to a shared library.

`translate` makes C of a physics module, `semantics.h` has what Python does where C does otherwise,
`table`, `instance.h` and the file of a version of FMI the functions around it, `link` the shared
libraries, `package` the FMU and `reference` the right-hand side of the monolith. Nothing else
imports this.
"""
