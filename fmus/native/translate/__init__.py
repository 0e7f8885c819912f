"""From the physics of a part to readable C99: one `.c` and one `.h`, the same names, the same bits.

What `docs/native-rules.md` allows is translated; all else is refused with file and line. `subset`
is the list of what is allowed, `unit` puts the text together.
"""
