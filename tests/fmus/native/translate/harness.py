"""Functions of a Python module and their translation, called alike."""

from __future__ import annotations

import ctypes
import inspect
import struct
import typing
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from fmus.native.link import PLATFORMS, compiled, compiler, own_platform
from fmus.native.package import HERE
from fmus.native.translate import unit, words

STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wno-unknown-pragmas"]
TAKEN = {float: "in[{k}]", int: "(int64_t)in[{k}]", bool: "in[{k}] != 0.0"}
DUALS = TAKEN | {float: "dual_of(in[{k}], seed[{k}])"}


class Translated:
    """Functions of numbers in both languages, by name."""

    def __init__(self, module: ModuleType, names: Sequence[str], folder: Path) -> None:
        self._module = module
        translation = unit.translated(module, "sample", names, {}, names)
        written(translation, folder)
        (folder / "calls.c").write_text(_calls(module, names), encoding="utf-8")
        self.source = translation.source
        platform = PLATFORMS[own_platform()]
        library = folder / f"sample{platform.suffix}"
        command = [*compiler(platform.targets[0], own=True), *STRICT]
        compiled([folder / "sample.c", folder / "calls.c"], library, command)
        self._library = ctypes.CDLL(str(library))

    def kinds(self, name: str) -> list[type[Any]]:
        """Types of a function's parameters."""
        return _kinds(getattr(self._module, name))[:-1]

    def python(self, name: str, *given: float) -> bytes | str:
        """Bits of the result as a float, or what the slave reports of the exception."""
        function: Callable[..., Any] = getattr(self._module, name)
        try:
            return _bits(float(function(*given)))
        except ValueError as error:
            return str(error)
        except (ArithmeticError, IndexError) as error:
            return repr(error)

    def c(self, name: str, *given: float) -> bytes | str:
        """The same from the translation."""
        call = getattr(self._library, f"call_{name}")
        call.restype = ctypes.c_char_p
        put = (ctypes.c_double * len(given))(*(float(value) for value in given))
        out = ctypes.c_double()
        cause: bytes | None = call(put, ctypes.byref(out))
        return _bits(out.value) if cause is None else cause.decode()

    def dual(self, name: str, given: Sequence[float], seed: Sequence[float]) -> tuple[Any, float]:
        """What `c` gives, but on dual numbers, and the slope of it along a seed."""
        call = getattr(self._library, f"dual_call_{name}")
        call.restype = ctypes.c_char_p
        row = ctypes.c_double * len(given)
        out = (ctypes.c_double * 2)()
        cause: bytes | None = call(row(*map(float, given)), row(*seed), out)
        return (_bits(out[0]) if cause is None else cause.decode()), out[1]


def written(translation: unit.Translation, folder: Path) -> None:
    """The files of a translation, with the headers that they include."""
    for name, text in {
        **{n: (HERE / n).read_text(encoding="utf-8") for n in ("semantics.h", "dual.h")},
        "words.h": words.header(),
        f"{translation.name}.h": translation.header,
        f"{translation.name}.c": translation.source,
    }.items():
        (folder / name).write_text(text, encoding="utf-8")


def _bits(value: float) -> bytes:
    """The bits of a float; all NaN are one."""
    return b"nan" if value != value else struct.pack("<d", value)


def _kinds(function: Callable[..., Any]) -> list[type[Any]]:
    hints = typing.get_type_hints(function)
    return [hints[name] for name in (*inspect.signature(function).parameters, "return")]


def _calls(module: ModuleType, names: Sequence[str]) -> str:
    """C that takes arguments from an array and hands over the cause of a failure."""
    lines = ['#include "sample.h"']
    for name in names:
        kinds = _kinds(getattr(module, name))[:-1]
        given = "".join(f", {TAKEN[kind].format(k=k)}" for k, kind in enumerate(kinds))
        lines += [
            '__attribute__((visibility("default")))',
            f"const char *call_{name}(const double *in, double *out);",
            f"const char *call_{name}(const double *in, double *out)",
            "{",
            "    Fault fault;",
            "    if (MARK(&fault))",
            "        return fault.cause;",
            f"    *out = (double)sample_{name}(&fault{given});",
            "    return NULL;",
            "}",
        ]
        dual = "".join(f", {DUALS[kind].format(k=k)}" for k, kind in enumerate(kinds))
        whole = _kinds(getattr(module, name))[-1] is not float
        made = f"sample_dual_{name}(&fault{dual})"
        lines += [
            '__attribute__((visibility("default")))',
            f"const char *dual_call_{name}(const double *in, const double *seed, double *out);",
            f"const char *dual_call_{name}(const double *in, const double *seed, double *out)",
            "{",
            "    Fault fault;",
            "    (void)in, (void)seed;",
            "    if (MARK(&fault))",
            "        return fault.cause;",
            f"    const Dual made = {f'dual_constant((double){made})' if whole else made};",
            "    out[0] = made.value, out[1] = made.slope;",
            "    return NULL;",
            "}",
        ]
    return "\n".join([*lines, ""])
