"""PathSim with its FMI toolbox: python docs/recipes/with_pathsim_fmi.py vehicle.ssp

Sequential, in the order of the blocks. It sets inputs that nothing feeds to zero whatever their FMU
starts with, which our parts bear.
"""

import sys
from importlib.metadata import version

from pathsim import Connection, Simulation
from pathsim.blocks import Scope
from pathsim_fmi import CoSimulationFMU
from structure import CYCLES, PER_CYCLE, STEP, Structure, told

structure = Structure.of(sys.argv[1])
blocks = {
    name: CoSimulationFMU(str(path), name, structure.starts[name], dt=STEP)
    for name, path in structure.fmus.items()
}
wires = [Connection(blocks[a][x], blocks[b][y]) for a, x, b, y in structure.wires]
scope = Scope()
wires.append(Connection(blocks["linkage"]["flap_angle"], scope[0]))
simulation = Simulation([*blocks.values(), scope], wires, dt=STEP, log=False)
simulation.run((CYCLES * PER_CYCLE - 1) * STEP)
times, (angles,) = scope.read()
told("pathsim-fmi", version("pathsim-fmi"), [float(t) + STEP for t in times], angles.tolist())
