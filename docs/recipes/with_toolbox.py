"""FMU Manipulation Toolbox: python docs/recipes/with_toolbox.py vehicle.ssp [container.fmu]

The whole vehicle as one FMU, its units stepped in sequence inside, run here by FMPy's own
simulator; any tool that takes FMUs takes it. The toolbox reads SSP too, but neither parameters nor
outputs from it: it is given its own JSON.
"""

import json
import shutil
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

from fmpy import simulate_fmu
from structure import CYCLES, PER_CYCLE, STEP, Structure, told

structure = Structure.of(sys.argv[1])
files = {name: path.name for name, path in structure.fmus.items()}
description = {
    "name": "vehicle.fmu", "step_size": STEP, "sequential": True, "mt": False, "profiling": False,
    "auto_link": False, "auto_input": False, "auto_output": False, "auto_parameter": False,
    "fmu": list(files.values()),
    "link": [[files[a], x, files[b], y] for a, x, b, y in structure.wires],
    "start": [
        [files[n], key, v] for n, given in structure.starts.items() for key, v in given.items()
    ],
    "output": [[files["linkage"], "flap_angle", "flap_angle"]],
}  # fmt: skip
folder = structure.folder / "resources"
(folder / "vehicle.json").write_text(json.dumps(description))
command = [Path(sys.executable).with_name("fmucontainer"), "-container", "vehicle.json"]
subprocess.run([*command, "-fmu-directory", str(folder)], check=True, capture_output=True)
if len(sys.argv) > 2:
    shutil.copy(folder / "vehicle.fmu", sys.argv[2])
table = simulate_fmu(
    str(folder / "vehicle.fmu"), stop_time=CYCLES * PER_CYCLE * STEP, step_size=STEP,
    output_interval=STEP, output=["flap_angle"],
)  # fmt: skip
release = f"{version('fmu-manipulation-toolbox')}, fmpy {version('fmpy')}"
told("toolbox", release, table["time"].tolist(), table["flap_angle"].tolist())
