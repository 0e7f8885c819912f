"""What both versions of FMI check alike: names, references, numbers, units, types."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from ...errors import printable
from ...units import Definition, declared
from .findings import Findings
from .variable import SIGNED, UNSIGNED, WHOLE, may_start

BOUNDED = ("Real", "Float64", "Float32", "Enumeration", *WHOLE)
"""Elements whose start, min and max are numbers."""
CAUSALITIES = ("parameter", "calculatedParameter", "input", "output", "local", "independent")
VARIABILITIES = ("constant", "fixed", "tunable", "discrete", "continuous")
TRUTHS = ("true", "false", "1", "0")
INTEGER = re.compile(r"[-+]?[0-9]{1,20}")
REFERENCE = re.compile(r"[0-9]{1,10}")
LARGEST_REFERENCE = 2**32 - 1


def number(text: str | None) -> float | None:
    """A number as XML writes it, not necessarily finite; None for anything else."""
    if text is None or "_" in text or not text.isascii():
        return None
    try:
        return float(text)
    except ValueError:
        return None


def bound(text: str | None) -> float | None:
    """A bound that can be kept to: a finite number."""
    value = number(text)
    return value if value is not None and math.isfinite(value) else None


def bounds(least: str | None, most: str | None) -> tuple[float | None, float | None]:
    """Both bounds of a variable; none where they contradict each other."""
    low, high = bound(least), bound(most)
    return (None, None) if low is not None and high is not None and low > high else (low, high)


def check_entry(entry: Any, names: set[str], causes: tuple[str, ...], findings: Findings) -> str:
    """Check name, reference, causality and variability of a variable; how messages call it."""
    name = entry.get("name") or ""
    shown = f"variable '{printable(name)}'"
    if not name or printable(name, most=1000) != name:
        findings.refuse(entry, f"{shown} has an empty or unprintable name")
    if name in names:
        findings.refuse(entry, f"{shown} is duplicated")
    names.add(name)
    reference = entry.get("valueReference")
    if not REFERENCE.fullmatch(reference or "") or int(reference) > LARGEST_REFERENCE:
        findings.refuse(entry, f"{shown} has valueReference {_quoted(reference)}, not a number")
    for key, known in (("causality", causes), ("variability", VARIABILITIES)):
        if (text := entry.get(key)) is not None and text not in known:
            findings.refuse(entry, f"{shown} has {key} {_quoted(text)}, which is none of FMI's")
    return shown


def check_numbers(entry: Any, typed: Any, shown: str, findings: Findings) -> None:
    """Check start, min and max of a variable whose type and values are in `typed`.

    A bad start value refuses the FMU where the value can be set; bounds that cannot be kept to
    count as none.
    """
    kind = str(typed.tag)
    settable = may_start(*map(entry.get, ("causality", "variability", "initial")))
    for fault in _start_faults(kind, typed.get("start")):
        if settable:
            findings.refuse(typed, f"{shown} has start {fault}")
        else:
            findings.warn(typed.sourceline, f"{shown} has start {fault}; ignored", "start")
    if kind in BOUNDED:
        for key in ("min", "max"):
            if (text := typed.get(key)) is not None and bound(text) is None:
                fault = f"{shown} has {key} {_quoted(text)}, which is not finite; ignored"
                findings.warn(typed.sourceline, fault, key)
        given = (typed.get("min"), typed.get("max"))
        if None not in map(bound, given) and bounds(*given) == (None, None):
            findings.warn(typed.sourceline, f"{shown} has min above max; both ignored", "bounds")


def check_ports(ports: Iterable[Any], findings: Findings) -> None:
    """Check our annotations of ports."""
    for port in ports:
        if not port.get("name") or port.get("order", "0") not in {"0", "1", "2"}:
            findings.refuse(port, "the port's annotation needs a name and an order 0, 1 or 2")


def _start_faults(kind: str, start: str | None) -> Iterator[str]:
    """What is wrong with a start value, or with each element of one."""
    if start is None or kind not in (*BOUNDED, "Boolean"):
        return
    for word in start.split() or [start]:
        shown = _quoted(word)
        if kind == "Boolean":
            if word not in TRUTHS:
                yield f"{shown}, which is neither true nor false"
        elif kind in (*WHOLE, "Enumeration"):
            if not INTEGER.fullmatch(word):
                yield f"{shown}, which is not a whole number"
            elif not _fits(kind, int(word)):
                yield f"{shown}, which does not fit {kind}"
        elif (value := number(word)) is None:
            yield f"{shown}, which is not a number"
        elif not math.isfinite(value):
            yield f"{printable(word)}, which is not finite"


def _fits(kind: str, value: int) -> bool:
    if kind in UNSIGNED:
        return 0 <= value < 1 << UNSIGNED[kind]
    half = 1 << (SIGNED.get(kind, 64) - 1)
    return -half <= value < half


def check_type(
    typed: Any, types: Mapping[str | None, Any], units: Units, shown: str, findings: Findings
) -> None:
    """Check that the declared type and the unit of a variable are defined."""
    name = typed.get("declaredType")
    if typed.tag == "Enumeration" and name not in types:
        findings.refuse(typed, f"{shown} has declaredType {_quoted(name)}, without its choices")
    elif name is not None and name not in types:
        findings.warn(
            typed.sourceline,
            f"{shown} has declaredType {_quoted(name)}, which is not defined: without its unit"
            " and bounds",
            f"type {name}",
        )
    units.check(typed, shown, findings)


def check_choices(entry: Any, findings: Findings) -> None:
    """Check names and numbers of an enumeration's choices."""
    for item in entry.findall("Item"):
        if not item.get("name") or not INTEGER.fullmatch(item.get("value") or ""):
            findings.refuse(item, "a choice of an enumeration needs a name and a whole number")


class Units:
    """Units that a description defines: the text for each name, as `orchestrator.units` reads it.

    A unit without base units means what its name says.
    """

    def __init__(self, root: Any) -> None:
        self._texts: dict[str | None, str] = {}
        self._faults: list[tuple[Any, str]] = []
        for unit in root.findall("UnitDefinitions/Unit"):
            name, base = unit.get("name") or "", unit.find("BaseUnit")
            self._texts[name] = name
            if base is None:
                continue
            try:
                self._texts[name] = declared(name, Definition.of(base.attrib))
            except ValueError as error:
                fault = f"unit {_quoted(name)} has no base units that are numbers"
                self._faults.append((unit, f"{fault} ({printable(str(error))}); its name counts"))

    def report(self, findings: Findings) -> None:
        """Note the definitions that cannot be read."""
        for unit, fault in self._faults:
            findings.warn(unit.sourceline, fault, "base units")

    def text(self, name: str | None) -> str:
        """Unit of a variable; an undefined name as it is."""
        return self._texts.get(name, name or "")

    def defines(self, name: str | None) -> bool:
        """Whether a name, if there is one, is defined."""
        return not name or name in self._texts

    def check(self, typed: Any, shown: str, findings: Findings) -> None:
        """Note a unit that is not defined."""
        name = typed.get("unit")
        if name is None or name in self._texts:
            return
        if name != printable(name):
            findings.refuse(typed, f"{shown} has unit {_quoted(name)}, which is unprintable")
            return
        fault = "an empty unit" if not name else f"unit '{name}', which is not defined"
        findings.warn(
            typed.sourceline, f"{shown} has {fault}; its numbers are taken as they are",
            f"unit {name}",
        )  # fmt: skip


def _quoted(text: str | None) -> str:
    return f"'{printable(text or '')}'"
