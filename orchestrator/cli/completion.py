"""What the shell offers on Tab: scenarios, masters, parameters, parts.

A completion that cannot be computed offers nothing: the command itself tells what is wrong.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

import typer

from ..errors import ResilinError

FILES = ("*.toml", "*.ssp")


def scenarios(incomplete: str) -> list[str]:
    """Shipped scenarios, and scenario files of the folder that is typed."""
    from ..scenario.files import scenario_names

    folder = Path(incomplete).parent
    with suppress(OSError):
        files = sorted(str(path) for pattern in FILES for path in folder.glob(pattern))
        return _beginning(incomplete, [*scenario_names(), *files])
    return []


def masters(incomplete: str) -> list[str]:
    """Names of the masters."""
    from ..simulation.masters import MASTERS

    return _beginning(incomplete, MASTERS)


def laws(incomplete: str) -> list[str]:
    """How much of each port can be connected."""
    from ..studies.precision.method import LAWS

    return _beginning(incomplete, LAWS)


def start_values(ctx: typer.Context, incomplete: str) -> list[tuple[str, str]]:
    """Parameters of the scenario on the line, as `component.parameter=`, with their meaning."""
    from ..scenario.library import LIBRARY
    from ..scenario.part_inspection import PARAMETERS
    from ..simulation.load import unloaded

    # behind an option that waits for its value, the parser leaves arguments in `args`
    scenario = ctx.params.get("scenario") or next(iter(ctx.args), "")
    with suppress(ResilinError, OSError):
        plan = unloaded(scenario, library=Path(ctx.params.get("fmus") or LIBRARY))
        return [
            (text, variable.description)
            for component, interface in plan.interfaces.items()
            for variable in interface.of(*PARAMETERS)
            if (text := f"{component}.{variable.name}=").startswith(incomplete)
        ]
    return []


def results(incomplete: str) -> list[str]:
    """Names of the results in the folder of results, and result files of the folder typed."""
    folder = Path(incomplete).parent
    with suppress(OSError):
        names = sorted(path.stem for path in Path("results").glob("*.nc"))
        files = sorted(str(path) for path in folder.glob("*.nc"))
        return _beginning(incomplete, dict.fromkeys([*names, *files]))
    return []


def parts(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of the built parts."""
    from ..scenario.library import LIBRARY, located, part_names

    with suppress(ResilinError, OSError):
        library = located(Path(ctx.params.get("fmus") or LIBRARY))
        return _beginning(incomplete, part_names(library))
    return []


def _beginning(incomplete: str, words: Iterable[str]) -> list[str]:
    return [word for word in words if word.startswith(incomplete)]
