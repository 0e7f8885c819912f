"""The physics of the vehicle and the slaves that carry it into FMUs.

Imports inside this tree are relative: the whole tree is renamed inside each FMU
so that two builds of one part can live in one process.
"""

__version__ = "0.1.0"
