"""The tools, by name. Each module imports its tool only when it runs."""

from __future__ import annotations

from .base import Tool
from .cofmu import Cofmu
from .ecos import Ecos
from .fmpy_ssp import FmpySsp
from .libcosim import Libcosim
from .mastersim import MasterSim
from .monolith import Monolith
from .omsimulator import OMSimulator
from .ours import Ours
from .pathsim import Pathsim

TOOLS: dict[str, Tool] = {
    tool.name: tool
    for tool in (
        Ours(), FmpySsp(), Ecos(), Libcosim(), Cofmu(), Pathsim(), OMSimulator(), MasterSim(),
        Monolith(),
    )
}  # fmt: skip
