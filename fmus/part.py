"""A part: the four functions and four records of one physics module, under one name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from types import ModuleType
from typing import Any

from .quantity import Quantity, quantities, starts


@dataclass(frozen=True)
class Variable:
    """One FMI variable of a part; its value reference is its place in :attr:`Part.variables`."""

    name: str
    field: str
    causality: str
    start: float
    quantity: Quantity

    @property
    def kind(self) -> str:
        """FMI 2 type: `Real`, or `Enumeration` where the quantity offers choices."""
        return "Enumeration" if self.quantity.choices else "Real"


@dataclass(frozen=True)
class Part:
    """A physics module with the name and the words it goes by outside.

    The module offers `Params, Input, State, Output`, all frozen dataclasses of floats, and

        initial(params, input, time) -> State
        advance(params, state, input, time, step) -> State
        observe(params, state, input, time) -> Output

    `step` is the communication step that suits the part alone [s]. `needs` names packages
    that the part imports from the host's Python at run time; empty means the standard
    library does. `includes` names the other parts whose physics it is made of. `generated`
    gives files that are made at build time and shipped: path in the tree -> path of the data
    file that it is made from, and the function from text to text.
    """

    name: str
    description: str
    physics: ModuleType
    step: float
    needs: tuple[str, ...] = ()
    includes: tuple[str, ...] = ()
    generated: dict[str, tuple[str, Callable[[str], str]]] = field(default_factory=dict)
    accuracy: float = 2.0e-8
    author: str = "The Resilin developers"
    license: str = "MIT"

    @property
    def variables(self) -> list[Variable]:
        """Inputs, parameters and outputs, in the order of their value references."""
        groups = (
            ("input", self.physics.Input),
            ("parameter", self.physics.Params),
            ("output", self.physics.Output),
        )
        return [
            Variable(quantity.fmi_name(field), field, causality, start, quantity)
            for causality, record in groups
            for (field, quantity), start in zip(
                quantities(record).items(), starts(record), strict=True
            )
        ]

    @property
    def origin(self) -> dict[str, str]:
        """Author and licence as attributes of a modelDescription; nothing where none is given."""
        given = {"author": self.author, "license": self.license}
        return {key: text for key, text in given.items() if text}

    def variables_with(self, changes: dict[str, float]) -> list[Variable]:
        """The variables, some with another start value."""
        return [
            replace(variable, start=changes.get(variable.name, variable.start))
            for variable in self.variables
        ]

    def dependencies(self, output: Variable) -> list[Variable]:
        """Inputs on which `output` depends without a step in between."""
        wanted = output.quantity.depends
        return [
            variable
            for variable in self.variables
            if variable.causality == "input"
            and (variable.name in wanted or variable.quantity.port in wanted)
        ]

    def params(self, **changes: float) -> Any:
        """`Params` with some fields changed, for use without FMI."""
        return self.physics.Params(**changes)
