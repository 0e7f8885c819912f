"""libcosim: python docs/recipes/with_libcosim.py vehicle.ssp

Compiled, Jacobi, time in whole nanoseconds: the step is rounded down, so that no step ends just
behind an edge of the drive. It wants the archive unpacked and reads the parameters; without a step
it takes that of an annotation which we write for it.
"""

import sys
from importlib.metadata import version

from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from structure import CYCLES, PER_CYCLE, STEP, Structure, told

log_output_level(CosimLogLevel.ERROR)
folder = Structure.of(sys.argv[1]).folder
execution = CosimExecution.from_ssp_file(str(folder), int(STEP * 1e9))
linkage = execution.slave_index_from_instance_name("linkage")
(angle,) = (v.reference for v in execution.slave_variables(linkage) if v.name == b"flap_angle")
count = CYCLES * PER_CYCLE
observer = CosimObserver.create_time_series(count + 2)
execution.add_observer(observer)
observer.start_time_series(linkage, angle, CosimVariableType.REAL)
if not execution.step(count):
    sys.exit("a step failed")
stamps, _, values = observer.time_series_real_samples(
    linkage, angle, from_step=1, sample_count=count
)
told("libcosim", version("libcosimpy"), [t * 1e-9 for t in stamps], values)
