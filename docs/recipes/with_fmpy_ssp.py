"""FMPy's simulate_ssp: python docs/recipes/with_fmpy_ssp.py vehicle.ssp

All components see what the others put out one step before (Jacobi). It starts every input at zero,
which our parts bear. Each row is stamped with the time before the step whose outcome it holds.
"""

import sys
from importlib.metadata import version

from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssv
from structure import CYCLES, PER_CYCLE, STEP, told

path = sys.argv[1]
parameters = read_ssv(path, "resources/parameters.ssv")
stop = (CYCLES * PER_CYCLE - 0.5) * STEP
table = simulate_ssp(path, stop_time=stop, step_size=STEP, parameter_set=parameters)
(name,) = (n for n in table.dtype.names if n.endswith("linkage.flap_angle"))
told("fmpy.ssp", version("fmpy"), [float(t) + STEP for t in table["time"]], table[name].tolist())
