"""Object code of a part's three functions, callable from C with plain arrays of doubles.

numba compiles `initial`, `advance` and `observe` to functions that take each field as a double,
fill in a record and return a status. A few lines of LLVM's text form around each make

    int part_advance(const double *params, const double *state, const double *input,
                     double time, double step, double *after)

which returns 0, or the number of a cause. What numba would hand to Python for an error, a
pickled exception, is replaced by that number; then everything but the three is internal, the
wrappers for Python die, and with them every symbol of Python. The text form is numba's own
affair and may change between versions: hence the pins, and the checks at the end.
"""

from __future__ import annotations

import dataclasses
import pickle
import re
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import llvmlite.binding as llvm
import numba

from .errors import NativeError
from .twin import Twins

ARGUMENTS = {"initial": "put", "advance": "pxuth", "observe": "pxut"}
"""The functions, and what they take: params, state x, input u, time, step h."""

RECORDS = {"p": "Params", "x": "State", "u": "Input"}
RESULTS = {"initial": "State", "advance": "State", "observe": "Output"}

LIBRARY = {
    "acos", "asin", "asinh", "atan", "atan2", "ceil", "copysign", "cos", "cosh", "exp", "expm1",
    "fabs", "floor", "log", "log10", "log1p", "log2", "memcpy", "memset", "pow", "sin", "sincos",
    "sinh", "sqrt", "tan", "tanh",
}  # fmt: skip
"""What object code may ask of the C library."""

PICKLED = re.compile(r'^@(?P<name>\.const\.pickledata\.[\w.]+) = .*? c"(?P<text>.*)"', re.M)
CAUSE = re.compile(
    r"^@(?P<name>\.const\.picklebuf\.[\w.]+) = .*?\{ ptr @(?P<data>\.const\.pickledata\.[\w.]+),"
    r".*$",
    re.M,
)
ADDRESS = re.compile(r"inttoptr \(i64 (?P<address>-?\d+) to ptr\)")
ESCAPED = re.compile(r"\\([0-9A-Fa-f]{2})")

numba.config.CPU_NAME = "generic"
numba.config.CPU_FEATURES = ""


@dataclass(frozen=True)
class Code:
    """LLVM module of a part as text, and the words for the causes 1, 2, ... it returns."""

    text: str
    causes: list[str]


def compiled(physics: ModuleType) -> Code:
    """Compile the three functions of a physics module.

    Raises :class:`NativeError` where numba refuses the source, or where the code would need
    anything but the C library.
    """
    twins = Twins(physics.__name__.split(".")[0])
    twin = twins.module(physics)
    causes: list[str] = []
    whole = llvm.parse_assembly("")
    for name, taken in ARGUMENTS.items():
        records = {key: getattr(physics, record) for key, record in RECORDS.items()}
        kinds = [twins.kind(records[a]) if a in RECORDS else numba.float64 for a in taken]
        text, symbol = _lowered(getattr(twin, name), tuple(kinds), f"{physics.__name__}.{name}")
        sizes = {key: len(dataclasses.fields(record)) for key, record in records.items()}
        text = _carrying(_numbered(text, causes), twins) + _wrapper(name, taken, sizes, symbol)
        module = llvm.parse_assembly(text)
        whole.link_in(_alone(module, f"part_{name}"))
    return Code(str(whole), causes)


def _lowered(dispatcher: Any, kinds: tuple[Any, ...], name: str) -> tuple[str, str]:
    """LLVM text of a function for some types, and the symbol that C can call."""
    try:
        dispatcher.compile(kinds)
    except numba.core.errors.NumbaError as error:
        told = [line for line in str(error).splitlines() if line.strip()]
        raise NativeError(f"{name}: numba cannot compile it: {' '.join(told[:4])}") from None
    signature = dispatcher.signatures[0]
    symbol = dispatcher.overloads[signature].fndesc.llvm_func_name
    return dispatcher.inspect_llvm(signature), symbol


def _numbered(text: str, causes: list[str]) -> str:
    """The text with each pickled exception replaced by the number of its cause."""
    pickled = {found["name"]: _bytes(found["text"]) for found in PICKLED.finditer(text)}

    def number(found: re.Match[str]) -> str:
        kind, arguments = pickle.loads(pickled[found["data"]])[:2]
        words = _worded(kind, arguments)
        if words not in causes:
            causes.append(words)
        return f"@{found['name']} = internal constant i32 {causes.index(words) + 1}"

    return CAUSE.sub(number, text)


def _carrying(text: str, twins: Twins) -> str:
    """The text with large tables in it: of those above a megabyte numba leaves an address."""
    tables = {table.ctypes.data: table for table in twins.tables}
    names: dict[int, str] = {}

    def named(found: re.Match[str]) -> str:
        address = int(found["address"]) % (1 << 64)
        if address not in tables:
            return found[0]
        names.setdefault(address, f"table.{len(names)}")
        return f"@{names[address]}"

    text = ADDRESS.sub(named, text)
    for address, name in names.items():
        data = tables[address].tobytes()
        content = "".join(f"\\{byte:02X}" for byte in data)
        text += f'\n@{name} = internal constant [{len(data)} x i8] c"{content}", align 8\n'
    return text


def _bytes(text: str) -> bytes:
    """The bytes of a string constant of LLVM."""
    pieces = ESCAPED.split(text)
    plain = [piece.encode("latin-1") for piece in pieces[::2]]
    coded = [bytes([int(piece, 16)]) for piece in pieces[1::2]] + [b""]
    return b"".join(a + b for a, b in zip(plain, coded, strict=True))


def _worded(kind: type[BaseException], arguments: tuple[Any, ...]) -> str:
    """What the Python slave says of an exception: in this Python's own words."""
    if issubclass(kind, ValueError):
        return str(arguments[0])
    usual: BaseException = kind(*arguments)
    zero = 0.0
    empty: tuple[float, ...] = ()
    try:
        if kind is ZeroDivisionError:
            _ = 1.0 / zero
        elif kind is IndexError:
            _ = empty[0]
    except (ZeroDivisionError, IndexError) as error:
        usual = error
    return repr(usual)


def _wrapper(name: str, taken: str, sizes: dict[str, int], symbol: str) -> str:
    """LLVM text of `part_NAME`."""
    own = ", ".join(f"double %{a}" if a in "th" else f"ptr %{a}" for a in taken)
    lines = [f"define hidden i32 @part_{name}({own}, ptr %out) {{", "  %place = alloca ptr"]
    lines.append("  store ptr null, ptr %place")
    passed = ["ptr %out", "ptr %place"]
    for a in taken:
        if a in "th":
            passed.append(f"double %{a}")
            continue
        for k in range(sizes[a]):
            lines.append(f"  %{a}.{k} = getelementptr inbounds double, ptr %{a}, i64 {k}")
            lines.append(f"  %{a}{k} = load double, ptr %{a}.{k}")
            passed.append(f"double %{a}{k}")
    lines += [
        f"  %status = call i32 @{symbol}({', '.join(passed)})",
        "  %well = icmp eq i32 %status, 0",
        "  br i1 %well, label %done, label %failed",
        "failed:",
        "  %cause = load ptr, ptr %place",
        "  %number = load i32, ptr %cause",
        "  ret i32 %number",
        "done:",
        "  ret i32 0",
        "}",
    ]
    return "\n".join(["", *lines, ""])


def _alone(module: Any, entry: str) -> Any:
    """The module with everything internal but its entry, and what is dead removed."""
    for item in [*module.functions, *module.global_variables]:
        if not item.is_declaration and item.name != entry:
            item.linkage = "internal"
    _optimise(module, _machine(llvm.get_default_triple()))
    foreign = [f.name for f in module.functions if f.is_declaration]
    foreign += [g.name for g in module.global_variables if g.is_declaration]
    strange = [n for n in foreign if not n.startswith("llvm.") and n not in LIBRARY]
    if strange:
        raise NativeError(f"{entry}: the code would need {', '.join(strange)}")
    if ADDRESS.search(str(module)):
        raise NativeError(f"{entry}: the code would hold an address of the process that made it")
    return module


def _optimise(module: Any, machine: Any) -> None:
    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)


def _machine(triple: str) -> Any:
    """A machine of a platform without any extension, so never with fused operations."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple(triple)
    return target.create_target_machine(cpu="generic", features="", opt=3, reloc="pic")


def emitted(code: Code, triple: str) -> bytes:
    """Object file of the code for a platform."""
    machine = _machine(triple)
    module = llvm.parse_assembly(code.text)
    module.triple = triple
    module.data_layout = str(machine.target_data)
    return bytes(machine.emit_object(module))
