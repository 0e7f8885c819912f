"""Foreign FMUs for model exchange: the models of exchange.c as FMI 2.0 or FMI 3.0."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import fmpy

from tests.foreign.build import compiled

SOURCE = Path(__file__).with_name("exchange.c")


@dataclass(frozen=True)
class Model:
    """Variables by causality, in the order of exchange.c: states are outputs with a derivative."""

    variables: dict[str, tuple[str, float]]
    states: tuple[str, ...] = ()
    indicators: int = 0
    follows: tuple[str, ...] = ()


MODELS = {
    "DECAY": Model(
        {"x": ("output", 1.0), "u": ("input", 0.0), "k": ("parameter", 1.0),
         "x_start": ("parameter", 1.0)},
        ("x",),
    ),
    "VAN_DER_POL": Model(
        {"x": ("output", 2.0), "y": ("output", 0.0), "mu": ("parameter", 1.0),
         "x_start": ("parameter", 2.0), "y_start": ("parameter", 0.0)},
        ("x", "y"),
    ),
    "BALL": Model(
        {"height": ("output", 1.0), "velocity": ("output", 0.0), "gravity": ("parameter", 9.81),
         "rebound": ("parameter", 0.7), "height_start": ("parameter", 1.0),
         "bounces": ("output", 0.0)},
        ("height", "velocity"), 1,
    ),
    "MASS": Model(
        {"x": ("output", 0.0), "v": ("output", 0.0), "f": ("input", 0.0), "m": ("parameter", 1.0),
         "x_start": ("parameter", 0.0)},
        ("x", "v"),
    ),
    "SPRING": Model(
        {"f1": ("output", 0.0), "f2": ("output", 0.0), "x1": ("input", 0.0), "v1": ("input", 0.0),
         "x2": ("input", 0.0), "v2": ("input", 0.0), "k": ("parameter", 1.0),
         "c": ("parameter", 0.0), "ground": ("parameter", 0.0)},
        follows=("x1", "v1", "x2", "v2"),
    ),
    "CLOCK": Model({"n": ("output", 0.0), "period": ("parameter", 0.25)}),
}  # fmt: skip


def exchanged(model: str, into: Path, version: int = 2, rollback: bool = True) -> Path:
    """Build one of `MODELS` into a folder and return its .fmu."""
    name = model.lower()
    platform = fmpy.platform if version == 2 else fmpy.platform_tuple
    into.mkdir(parents=True, exist_ok=True)
    path = into / f"{name}.fmu"
    described = (_second if version == 2 else _third)(model, name, rollback)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", described)
        library = f"binaries/{platform}/{name}{fmpy.sharedLibraryExtension}"
        archive.writestr(library, _compiled(model, version))
    return path


@cache
def _compiled(model: str, version: int) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        macros = [f"MODEL_{model}", f"FMI_VERSION={version}", f'TOKEN="{{{model}}}"']
        return compiled(SOURCE, macros, Path(folder))


def _described(facts: Model) -> Iterator[tuple[str, str]]:
    """Attributes of each variable that both versions write in the same way, and its start."""
    for k, (variable, (causality, start)) in enumerate(facts.variables.items()):
        output = causality == "output"
        variability = ' variability="fixed"' if causality == "parameter" else ""
        initial = ' initial="calculated"' if output else ""
        yield (
            f'name="{variable}" valueReference="{k}" causality="{causality}"{variability}{initial}',
            "" if output else f' start="{start}"',
        )


def _second(model: str, name: str, rollback: bool) -> str:
    facts = MODELS[model]
    names = list(facts.variables)
    scalars = [
        f"<ScalarVariable {attributes}><Real{start}/></ScalarVariable>"
        for attributes, start in _described(facts)
    ]
    for k, state in enumerate(facts.states):
        derivative = f'<Real derivative="{names.index(state) + 1}"/>'
        scalars.append(
            f'<ScalarVariable name="der({state})" valueReference="{100 + k}" causality="local"'
            f' initial="calculated">{derivative}</ScalarVariable>'
        )
    follows = " ".join(str(names.index(each) + 1) for each in facts.follows)
    outputs = "".join(
        f'<Unknown index="{names.index(v) + 1}" dependencies="{follows}"/>'
        for v, (causality, _) in facts.variables.items()
        if causality == "output"
    )
    rates = "".join(f'<Unknown index="{len(names) + k + 1}"/>' for k in range(len(facts.states)))
    derivatives = f"<Derivatives>{rates}</Derivatives>" if rates else ""
    initial = f"<InitialUnknowns>{outputs}{rates}</InitialUnknowns>"
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        f'<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{{{model}}}"'
        f' numberOfEventIndicators="{facts.indicators}">'
        f'<ModelExchange modelIdentifier="{name}" canGetAndSetFMUstate="{str(rollback).lower()}"/>'
        f"<ModelVariables>{''.join(scalars)}</ModelVariables>"
        f"<ModelStructure><Outputs>{outputs}</Outputs>{derivatives}{initial}</ModelStructure>"
        "</fmiModelDescription>"
    )


def _third(model: str, name: str, rollback: bool) -> str:
    facts = MODELS[model]
    names = list(facts.variables)
    variables = [f"<Float64 {attributes}{start}/>" for attributes, start in _described(facts)]
    variables += [
        f'<Float64 name="der({state})" valueReference="{100 + k}" causality="local"'
        f' initial="calculated" derivative="{names.index(state)}"/>'
        for k, state in enumerate(facts.states)
    ]
    follows = " ".join(str(names.index(each)) for each in facts.follows)
    outputs = "".join(
        f'<Output valueReference="{names.index(v)}" dependencies="{follows}"/>'
        for v, (causality, _) in facts.variables.items()
        if causality == "output"
    )
    rates = "".join(
        f'<ContinuousStateDerivative valueReference="{100 + k}"/>' for k in range(len(facts.states))
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        f'<fmiModelDescription fmiVersion="3.0" modelName="{name}"'
        f' instantiationToken="{{{model}}}">'
        f'<ModelExchange modelIdentifier="{name}" canGetAndSetFMUState="{str(rollback).lower()}"/>'
        f"<ModelVariables>{''.join(variables)}</ModelVariables>"
        f"<ModelStructure>{outputs}{rates}</ModelStructure></fmiModelDescription>"
    )
