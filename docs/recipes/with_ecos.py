"""Ecos: python docs/recipes/with_ecos.py vehicle.ssp

Compiled, Jacobi. Parameters count only where their set is named; ours is called initialValues.
Needs libtbb, which `pip install tbb` puts beside the interpreter.
"""

import ctypes
import sys
from importlib.metadata import version
from pathlib import Path

from structure import CYCLES, PER_CYCLE, STEP, told

for library in sorted((Path(sys.prefix) / "lib").glob("libtbb.so.12*"))[:1]:
    ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)

from ecospy import EcosLib, EcosSimulation  # noqa: E402

EcosLib.set_log_level("off")
times, angles = [], []
with EcosSimulation(STEP, ssp_path=sys.argv[1]) as simulation:
    if not simulation.init(0.0, "initialValues"):
        sys.exit(EcosLib.get_last_error())
    for _ in range(CYCLES * PER_CYCLE):
        simulation.step(1)
        times.append(simulation.get_time())
        angles.append(simulation.get_real("linkage::flap_angle"))
    told("ecos", version("ecospy"), times, angles)
