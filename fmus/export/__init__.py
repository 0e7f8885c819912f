"""Parts as FMUs: their sources staged as a package, exported or compiled, and sealed.

`sources` finds what a part is made of, `staging` makes a package of it, `archive` the file,
`build` does all three.
"""
