"""Attributes that FMI 2.0 and 3.0 share: those of the root, and of what the FMU is for."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from .variable import Interface, Variable

NAMES = {
    2: ("guid", "canGetAndSetFMUstate"),
    3: ("instantiationToken", "canGetAndSetFMUState"),
}
"""What each version calls the identity of a description, and the ability to go back."""


def interface(
    path: Path,
    root: Any,
    version: int,
    variables: dict[str, Variable],
    warnings: tuple[str, ...],
) -> Interface:
    """The `Interface` of a description of a version of FMI whose variables have been read."""
    identity, state = NAMES[version]
    kind = root.find("CoSimulation")
    exchange = kind is None
    if exchange:
        kind = root.find("ModelExchange")
    tool = root.get("generationTool") or ""
    return Interface(
        path=path,
        version=version,
        model=root.get("modelName") or kind.get("modelIdentifier"),
        identifier=kind.get("modelIdentifier"),
        guid=root.get(identity),
        tool=tool,
        variables=variables,
        rollback=exchange or true(kind.get(state)),
        restarts=exchange and not true(kind.get(state)),
        variable_step=exchange or true(kind.get("canHandleVariableCommunicationStepSize")),
        once=true(kind.get("canBeInstantiatedOnlyOncePerProcess")),
        needs_tool=true(kind.get("needsExecutionTool")),
        ours=tool.startswith("Resilin"),
        warnings=warnings,
        step=preferred_step(root),
        model_exchange=exchange,
        states=len(root.findall("ModelStructure/Derivatives/Unknown")),
        rates=version == 2 and not exchange and _count(kind.get("maxOutputDerivativeOrder")) > 0,
        interpolates=exchange or (version == 2 and true(kind.get("canInterpolateInputs"))),
        indicators=_count(root.get("numberOfEventIndicators")),
    )


def _count(text: str | None) -> int:
    """A number of things in XML; 0 where it is none."""
    return int(text) if text is not None and text.isascii() and text.isdigit() else 0


def preferred_step(root: Any) -> float | None:
    """Communication step of the default experiment [s]; None unless it is positive and finite."""
    experiment = root.find("DefaultExperiment")
    try:
        step = float(experiment.get("stepSize")) if experiment is not None else 0.0
    except (TypeError, ValueError):
        return None
    return step if 0.0 < step < math.inf else None


def true(value: Any) -> bool:
    """Whether an attribute of XML is true."""
    return value in {"true", "1"}
