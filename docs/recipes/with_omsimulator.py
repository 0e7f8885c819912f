"""OMSimulator 3: python docs/recipes/with_omsimulator.py vehicle.ssp

Written to its documentation and not run here: its package fetches the program from a site of its
own.
"""

import sys
from importlib.metadata import version

from OMSimulator import SSP, CRef
from structure import CYCLES, PER_CYCLE, STEP, told

model = SSP(sys.argv[1]).instantiate()
model.setFixedStepSize(STEP)
model.setStopTime(CYCLES * PER_CYCLE * STEP)
model.initialize()
times, angles = [], []
for k in range(1, CYCLES * PER_CYCLE + 1):
    model.stepUntil(k * STEP)
    times.append(k * STEP)
    angles.append(float(model.getValue(CRef("default", "linkage", "flap_angle"))))
model.terminate()
model.delete()
told("omsimulator", version("OMSimulator"), times, angles)
