"""The variables of the foreign models: one table for modelDescription.xml and for the C source."""

from __future__ import annotations

import uuid
from dataclasses import dataclass, replace

Start = float | int | bool | str | tuple[float, ...]

FAULTS = {
    0: "none",
    1: "crash",
    2: "hang",
    3: "NaN",
    4: "exit(0)",
    5: "abort",
    6: "memory without end",
    7: "10 MB of log and of stdout, once",
    8: "discard",
    9: "error",
    10: "fatal",
    11: "earlyReturn (FMI 3)",
    12: "terminateSimulation (FMI 3)",
    13: "crash in freeInstance",
    14: "hang in instantiate (this value must be compiled in)",
    15: "output growing tenfold each step",
    16: "hang in terminate",
    17: "eventHandlingNeeded (FMI 3)",
    18: "a process left behind in a session of its own",
}
CHOICES = ("slow", "fast")
WHOLE = ("Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")


@dataclass(frozen=True)
class Variable:
    """One variable: `kind` is named as in FMI 3, `follows` are the inputs an output depends on.

    An output that is `exact` starts with its start value.
    """

    name: str
    kind: str
    causality: str
    description: str
    unit: str = ""
    start: Start = 0.0
    variability: str = "continuous"
    least: float | None = None
    most: float | None = None
    shape: tuple[int, ...] = ()
    port: str = ""
    order: int = 0
    follows: tuple[str, ...] = ()
    exact: bool = False


@dataclass(frozen=True)
class Model:
    """A foreign model in one version of FMI."""

    name: str
    description: str
    variables: tuple[Variable, ...]

    @property
    def identifier(self) -> str:
        """The modelIdentifier, hence the name of the shared library."""
        return self.name.lower()

    @property
    def token(self) -> str:
        """GUID or instantiationToken: the same in every build."""
        return str(uuid.uuid5(uuid.NAMESPACE_DNS, f"{self.identifier}.foreign.test"))

    def reference(self, name: str) -> int:
        """Value reference of a variable: its place in the table, from 0."""
        return [variable.name for variable in self.variables].index(name)


def named(name: str, version: int) -> Model:
    """One of `MODELS` for FMI 2 or 3; in FMI 3 the independent variable is the last."""
    description, variables = MODELS[name]
    if name == "TYPES":
        variables = _types(version)
    if version == 3:
        time = Variable("time", "Float64", "independent", "Time of the FMU", "s")
        variables = (*variables, time)
    return Model(name, description, variables)


def _real(name: str, causality: str, unit: str, description: str) -> Variable:
    return Variable(name, "Float64", causality, description, unit)


def _input(name: str, unit: str, description: str) -> Variable:
    return _real(name, "input", unit, description)


def _output(name: str, unit: str, description: str, *follows: str) -> Variable:
    return replace(_real(name, "output", unit, description), follows=follows)


def _parameter(
    name: str, unit: str, description: str, start: float, least: float | None = None
) -> Variable:
    plain = _real(name, "parameter", unit, description)
    return replace(plain, start=start, least=least, variability="fixed")


def _member(port: str, order: int, variable: Variable) -> Variable:
    """A member of a port; the port's name is put in front of its own."""
    follows = tuple(name if "." in name else f"{port}.{name}" for name in variable.follows)
    name = f"{port}.{variable.name}"
    return replace(variable, name=name, port=port, order=order, follows=follows)


def _law(port: str, other: str) -> tuple[Variable, ...]:
    """Force on one mass of a pair, linear about the state at which it was sampled."""
    positions = (f"{port}.displacement", f"{other}.displacement")
    moving = (f"{port}.velocity", f"{other}.velocity")
    value = _output("value", "N", "Force at the reference", *positions, *moving)
    rest = (
        _output("stiffness", "N/m", "Restoring force per displacement of this mass"),
        _output("damping", "N.s/m", "Restoring force per velocity of this mass"),
        _output("rate", "N/s", "Growth of the force as the other moves", f"{other}.velocity"),
        _output("reference_displacement", "m", "Displacement of the sample", "displacement"),
        _output("reference_velocity", "m/s", "Velocity of the sample", "velocity"),
        _output("reference_time", "s", "Time of the sample"),
    )
    return (_member(port, 0, value), *(_member(port, 1, member) for member in rest))


def _tunable(name: str, unit: str, description: str, start: float) -> Variable:
    return replace(_parameter(name, unit, description, start), variability="tunable")


PAIR = (
    *(
        _member(port, 0, variable)
        for port in ("first", "second")
        for variable in (
            _input("displacement", "m", f"Displacement of the {port} mass"),
            _input("velocity", "m/s", f"Velocity of the {port} mass"),
        )
    ),
    _tunable("stiffness", "N/m", "Spring between the masses", 1.0),
    _tunable("ground_stiffness", "N/m", "Spring between each mass and the ground", 1.0),
    _tunable("damping", "N.s/m", "Damper between the masses", 0.0),
    *_law("first", "second"),
    *_law("second", "first"),
)

MASS = (
    _input("force", "N", "Force on the mass"),
    _parameter("mass", "kg", "Mass", 1.0, least=1e-9),
    _parameter("stiffness", "N/m", "Spring to the ground", 0.0, least=0.0),
    _parameter("damping", "N.s/m", "Damper to the ground", 0.0, least=0.0),
    _parameter("start_displacement", "m", "Displacement at the start", 0.0),
    _parameter("start_velocity", "m/s", "Velocity at the start", 0.0),
    _output("displacement", "m", "Displacement"),
    _output("velocity", "m/s", "Velocity"),
)

POPULATION = (
    _input("other", "1", "Size of the other population"),
    _parameter("growth", "1/s", "Rate of growth without the other", 1.0),
    _parameter("effect", "1/s", "What the other adds to it per head", 0.0),
    _parameter("start_size", "1", "Size at the start", 1.0, least=0.0),
    _output("size", "1", "Size of the population"),
)

GAIN = (
    _input("u", "1", "What is amplified"),
    _parameter("gain", "1", "Amplification", 1.0),
    _parameter("offset", "1", "Output at zero input", 0.0),
    _output("y", "1", "gain u + offset", "u"),
)

LAG = (
    _input("u", "1", "What is followed"),
    _parameter("start", "1", "Output at the start", 0.0),
    _output("y", "1", "y' = u - y, with a time constant of 1 s"),
)

DECAY = (
    replace(_output("x", "", "What decays: x' = -k x"), start=1.0, exact=True),
    _parameter("k", "1/s", "Rate of decay", 1.0),
    replace(_output("rate", "1/s", "-k x"), causality="local"),
    Variable("eager", "Boolean", "parameter", "Whether it integrates to the stop time at once",
             start=False, variability="fixed"),
    Variable("table", "String", "parameter", "A file", start="", variability="fixed"),
    _output("found", "", "First number in the file"),
)  # fmt: skip

_OPEN = Variable(
    "open", "Boolean", "input", "Whether the valve is open", start=False, variability="discrete"
)

TANK = (
    _OPEN,
    _parameter("inflow", "1/s", "Inflow of an open valve", 1.0),
    _parameter("k", "1/s", "Outflow per level", 1.0),
    _parameter("start_level", "1", "Level at the start", 0.0),
    _output("level", "1", "Level: level' = open inflow - k level"),
)

RELAY = (
    _input("level", "1", "What is held between the bounds"),
    _parameter("low", "1", "The valve opens below it", 0.4),
    _parameter("high", "1", "The valve closes above it", 0.6),
    replace(_OPEN, causality="output", start=None),
    Variable("state", "String", "output", "The valve in words", variability="discrete"),
)

FAULTY = (
    *GAIN,
    _output("x", "s", "Integral of u over time"),
    Variable(
        "fault",
        "Int32",
        "parameter",
        "; ".join(f"{number} {meaning}" for number, meaning in FAULTS.items()),
        start=0,
        variability="fixed",
        least=0,
        most=max(FAULTS),
    ),
    _parameter("fault_time", "s", "The first step that reaches it is the first to fail", 0.5),
)


def _echo(kind: str, version: int, *, start: Start) -> tuple[Variable, ...]:
    """Input, direct echo and echo of the step before, of one scalar type."""
    short = {"Float64": "real", "Int32": "integer"}.get(kind) if version == 2 else None
    name = short or kind.lower()
    real = kind.startswith("Float")
    given = Variable(f"in_{name}", kind, "input", f"A number of type {kind}", start=start)
    given = replace(given, variability="continuous" if real else "discrete")
    changed = {"Boolean": "negated", **dict.fromkeys(WHOLE, "plus 1, while there is room")}
    meaning = f"in_{name} {changed.get(kind, 'as it is')}"
    echo = replace(given, name=f"out_{name}", causality="output", description=meaning)
    late = replace(echo, name=f"late_{name}", description=f"out_{name} before the last step")
    return given, replace(echo, follows=(given.name,)), late


def _types(version: int) -> tuple[Variable, ...]:
    """Every type of a version of FMI, except clocks."""
    reals = ("Float64",) if version == 2 else ("Float64", "Float32")
    wholes = ("Int32",) if version == 2 else WHOLE
    text = Variable(
        "in_string", "String", "parameter", "A text", start="Flügel", variability="fixed"
    )
    variables = (
        *(variable for kind in reals for variable in _echo(kind, version, start=0.0)),
        *(variable for kind in wholes for variable in _echo(kind, version, start=0)),
        *_echo("Boolean", version, start=False),
        *_echo("Enumeration", version, start=1),
        text,
        Variable("out_string", "String", "output", "in_string as it is", variability="discrete"),
    )
    if version == 2:
        return variables
    array = replace(_input("in_array", "", "Three numbers"), start=(0.0,) * 3, shape=(3,))
    matrix = _parameter("in_matrix", "", "A matrix, row by row", 0.0)
    matrix = replace(matrix, start=(1.0, 2.0, 3.0, 4.0), shape=(2, 2))
    return (
        *variables,
        Variable("out_binary", "Binary", "output", "00 ff in_string", variability="discrete"),
        array,
        replace(_output("out_array", "", "2 in_array", "in_array"), shape=(3,)),
        matrix,
        replace(_output("out_matrix", "", "in_matrix, transposed"), shape=(2, 2)),
    )


MODELS: dict[str, tuple[str, tuple[Variable, ...]]] = {
    "PAIR": ("Two springs between two masses and the ground", PAIR),
    "MASS": ("A mass, a spring and a damper: m x'' + d x' + k x = force", MASS),
    "POPULATION": ("Of prey or of its predators: x' = (growth + effect other) x", POPULATION),
    "GAIN": ("y = gain u + offset, at once", GAIN),
    "LAG": ("y' = u - y", LAG),
    "TYPES": ("Echoes of every type of variable", ()),
    "DECAY": ("x' = -k x, with a start value, a file and a local variable", DECAY),
    "TANK": ("level' = open inflow - k level, with a Boolean input", TANK),
    "RELAY": ("A two-point controller with a Boolean output and a text", RELAY),
    "FAULTY": ("A gain that fails on demand", FAULTY),
}
