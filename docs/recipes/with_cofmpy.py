"""CoFMPy: python docs/recipes/with_cofmpy.py vehicle.ssp

Its Gauss-Seidel steps a loop in the order of a Python set, which changes from process to process:
here it is given that of the file. It pins an older fmpy, so it wants an environment of its own.
"""

import contextlib
import io
import sys
from importlib.metadata import version

from cofmupy import Coordinator
from structure import CYCLES, PER_CYCLE, STEP, Structure, told

structure = Structure.of(sys.argv[1])
names = list(structure.fmus)
configuration = {
    "root": "", "edge_sep": " -> ", "cosim_method": "gauss_seidel", "iterative": False,
    "fmus": [
        {"id": n, "name": n, "path": str(path), "initialization": structure.starts[n]}
        for n, path in structure.fmus.items()
    ],
    "connections": [
        {
            "source": {"type": "fmu", "id": a, "variable": x, "unit": ""},
            "target": {"type": "fmu", "id": b, "variable": y, "unit": ""},
        }
        for a, x, b, y in structure.wires
    ],
    "data_storages": [],
}  # fmt: skip
coordinator = Coordinator()
with contextlib.redirect_stdout(io.StringIO()):
    coordinator.start(configuration)
master = coordinator.master
master.sequence_order = [sorted(group, key=names.index) for group in master.sequence_order]
for _ in range(CYCLES * PER_CYCLE):
    coordinator.do_step(STEP)
angles = [float(a) for a in coordinator.get_results()["linkage", "flap_angle"]]
told("cofmpy", version("cofmupy"), [(k + 1) * STEP for k in range(len(angles))], angles)
