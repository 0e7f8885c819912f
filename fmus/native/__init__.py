"""Parts without Python: from the same physics source to object code behind a C layer.

`mathematics` and `twin` give a physics module that numba compiles, `code` its object code,
`table` and `layer.c` the FMI 2 functions around it, `link` the shared libraries and `package`
the FMU. Needs the packages of the extra `native`, to build only; nothing else imports this.
"""
