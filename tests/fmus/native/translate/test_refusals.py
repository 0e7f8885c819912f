"""What the rules do not allow is refused with file and line, and nothing else is."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

from fmus.native.errors import NativeError
from fmus.native.translate import unit

HEAD = """from __future__ import annotations
import math
import json
import dataclasses
from dataclasses import dataclass

LEAST = 1.0
ROW = (1.0, 2.0)
RAGGED = ((1.0, 2.0), (3.0,))
COUNTS = (1, 2)
NOTHING = ()
WORDS = "x"
CUBE = (((1.0,),),)

@dataclass(frozen=True)
class Pose:
    x: float
    y: float = 0.0

def helper(x: float, y: float = 1.0) -> float:
    return x + y

"""
FIRST = HEAD.count("\n") + 2
"""Line of a function's first statement."""

STATEMENTS = {
    "a = [x]": "outside the subset",
    "a = [i for i in (1, 2)]": "outside the subset",
    "a = {1: x}": "outside the subset",
    "a = {x}": "outside the subset",
    "a = lambda: x": "outside the subset",
    "a = f'{x}'": "outside the subset",
    "a = (b := x)": "outside the subset",
    "a = x ** 2.0": "write products",
    "a = 1 << 2": "outside the subset",
    "a = ~1": "outside the subset",
    "a = x is None": "outside the subset",
    "a = x in ROW": "outside the subset",
    "a = 'text'": "neither a number nor a truth value",
    "a = None": "neither a number nor a truth value",
    "a = 1j": "neither a number nor a truth value",
    "a = 1 + x": "write 1.0",
    "a = x < 1": "compares a float with an int",
    "a = 1 / 2": "divides two ints",
    "a = math.floor(x) + math.ceil(x)": "are ints",
    "a = -math.floor(x)": "write float() around it",
    "a = True + x": "is a bool",
    "a = x and y": "write the comparison that is meant",
    "a = not x": "write the comparison that is meant",
    "a = (x > 0.0) == (y > 0.0)": "compares a bool with a bool",
    "a = x if y > 0.0 else 1": "is a float or an int",
    "a = x if y else 1.0": "write the comparison that is meant",
    "a = abs(x)": "abs() is outside the subset",
    "a = sum(ROW)": "sum() is outside the subset",
    "a = len(ROW)": "len() is outside the subset",
    "a = round(x)": "round() is outside the subset",
    "a = max(x)": "two arguments or more",
    "a = max(x, 1)": "floats only, or ints only",
    "a = max(x, y, key=helper)": "without names",
    "a = int(x, 10)": "takes one argument",
    "a = float('inf')": "neither a number",
    "a = math.log(x, 2.0)": "takes 1 argument here",
    "a = math.hypot(x, y)": "math.hypot is outside the subset",
    "a = math.tau": "math.tau is outside the subset",
    "a = math.inf": "math.inf is outside the subset",
    "a = math.sqrt(True)": "a float is needed",
    "a = json.loads(x)": "json is outside the subset",
    "a = json.decoder": "json is outside the subset",
    "a = dataclasses.replace(x)": "dataclasses is outside the subset",
    "a = x.real": "has no fields",
    "a = Pose(1.0, 2.0).x": "give all fields by name",
    "a = Pose(x=x).x": "give all fields by name",
    "a = Pose(x=x, y=1).x": "field y (`1`) is an int",
    "a = Pose(x=x, y=y).z": "has no field z",
    "a = Pose": "not a number or a table",
    "a = helper": "not a number or a table",
    "a = WORDS": "not a number or a table",
    "a = helper()": "no argument x",
    "a = helper(x, y, x)": "takes 2 arguments",
    "a = helper(x, z=y)": "argument z",
    "a = helper(x, x=y)": "argument x",
    "a = helper(*ROW)": "stars",
    "a = helper(1)": "write float()",
    "a = helper(math.floor(x))": "write float()",
    "a = g(x)": "calls itself",
    "a = unknown": "unknown is not known",
    "a = unknown(x)": "unknown is not known; define or import it",
    "a = fabs(x)": "fabs is not known; write math.fabs, with import math",
    "a = cmath.sqrt(x)": "cmath is not imported; write import cmath",
    "a = x.hex()": "outside the subset",
    "a = ROW[0.5]": "an int is needed",
    "a = ROW[2]": "beyond 2 entries",
    "a = ROW[-3]": "beyond 2 entries",
    "a = ROW[0:1]": "outside the subset",
    "a = x[0]": "has no entries",
    "a = (x, 1)[int(y)]": "written as a number",
    "a = CUBE": "down to two dimensions",
    "a, b = x": "cannot be unpacked",
    "a, b = x, y, x": "3 values for 2 variables",
    "a, (b, c) = x, (y, x)": "only variables",
    "a = b = x": "one variable at a time",
    "x.a = y": "only variables",
    "a: float": "a variable needs a value",
    "a = x\n    a = 1": "a is a float before, and an int here",
    "a = b\n    b = x": "b may have no value here",
    "if x > 0.0:\n        a = x\n    return a": "a may have no value here",
    "for i in range(2):\n        a = x\n    return a": "a may have no value here",
    "for i in range(2):\n        i = 1": "assigned in the loop",
    "for i in range(2):\n        for i in range(3):\n            pass": "assigned in the loop",
    "i = 1\n    for i in range(2):\n        pass\n    return float(i)": "the variable of a loop",
    "for x in range(2):\n        pass": "another variable already",
    "for i in ROW:\n        pass": "range(n)",
    "for i in range(1, 2):\n        pass": "range(n)",
    "for i in range(2):\n        pass\n    else:\n        pass": "no else",
    "for i in range(x):\n        pass": "an int is needed",
    "while x > 0.0:\n        pass\n    else:\n        pass": "else after a loop",
    "while x:\n        pass": "write the comparison that is meant",
    "if x:\n        pass": "write the comparison that is meant",
    "try:\n        pass\n    finally:\n        pass": "outside the subset",
    "with open('x'):\n        pass": "outside the subset",
    "assert x > 0.0": "outside the subset",
    "del x": "outside the subset",
    "global LEAST": "outside the subset",
    "import json": "outside the subset",
    "def inner():\n        pass": "outside the subset",
    "x > 0.0": "a value that nothing takes",
    "raise KeyError('x')": 'raise ValueError("constant text")',
    "raise ValueError(f'{x}')": 'raise ValueError("constant text")',
    "raise ValueError('a', 'b')": 'raise ValueError("constant text")',
    "raise": 'raise ValueError("constant text")',
    "return": "a function returns a value",
    "return 1": "write float()",
    "return math.floor(x)": "write float()",
    "return x, y": "a tuple of 2",
    "a = RAGGED[0][0]": "rows of different lengths",
    "a = COUNTS[0]": "holds 1, which is not a float",
    "a = NOTHING[0]": "is empty",
}
FUNCTIONS = {
    "def f(x, y: float) -> float:\n    return y": "not annotated",
    "def f(x: float, y: float):\n    return y": "not annotated",
    "def f(x: str, y: float) -> float:\n    return y": "outside the subset",
    "def f(x: Unknown, y: float) -> float:\n    return y": "name 'Unknown' is not defined",
    "def f(x: float, *y: float) -> float:\n    return x": "plain parameters only",
    "def f(x: float, *, y: float) -> float:\n    return x": "plain parameters only",
    "def f(x: float, y: float) -> float:\n    if x > y:\n        return x": "without a return",
    "@dataclass\nclass Loose:\n    x: float\n"
    "def f(x: float, y: float) -> float:\n    return Loose(x=x).x": "not a frozen dataclass",
    "@dataclass(frozen=True)\nclass Odd:\n    x: int\n"
    "def f(x: float, y: float) -> float:\n    return Odd(x=1).x": "Odd.x is not a float",
    "@dataclass(frozen=True)\nclass Able:\n    x: float\n    def m(self): return 1\n"
    "def f(x: float, y: float) -> float:\n    return Able(x=x).x": "fields only",
}


def refusal(folder: Path, text: str) -> str:
    """What the translator says of the function `f` of a module."""
    path = folder / "refused.py"
    path.write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("refused", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["refused"] = module
    try:
        spec.loader.exec_module(module)
        with pytest.raises(NativeError) as caught:
            unit.translated(module, "refused", ["f"], {})
    finally:
        del sys.modules["refused"]
    return str(caught.value)


@pytest.mark.parametrize("statement", STATEMENTS)
def test_a_statement_is_refused_where_it_stands(tmp_path: Path, statement: str) -> None:
    body = f"def f(x: float, y: float) -> float:\n    {statement}\n    return x\n"
    tail = "\ndef g(x: float) -> float:\n    return f(x, x)\n"
    said = refusal(tmp_path, HEAD + body + tail)
    expected = STATEMENTS[statement]
    assert expected in said
    line = int(said.split("refused.py:")[1].split(":")[0])
    lines = (HEAD + body).splitlines()
    assert "docs/native-rules.md" in said
    if statement.split(" ")[-1].startswith(("RAGGED", "COUNTS", "NOTHING")):
        assert lines[line - 1].startswith(statement.split(" ")[-1].split("[")[0])
    elif "g(x)" not in statement:
        assert FIRST <= line < FIRST + len(statement.splitlines()) + 1


@pytest.mark.parametrize("value", ["math.fabs(x)", "x * math.pi"])
def test_a_missing_import_is_named(tmp_path: Path, value: str) -> None:
    body = f"def f(x: float, y: float) -> float:\n    return {value}\n"
    said = refusal(tmp_path, HEAD.replace("import math\n", "") + body)
    assert "math is not imported; write import math" in said


@pytest.mark.parametrize("text", FUNCTIONS)
def test_a_definition_is_refused(tmp_path: Path, text: str) -> None:
    said = refusal(tmp_path, HEAD + text)
    assert FUNCTIONS[text] in said
    assert "refused.py:" in said


def test_the_usual_is_not_refused(tmp_path: Path) -> None:
    with pytest.raises(pytest.fail.Exception, match="DID NOT RAISE"):
        refusal(tmp_path, HEAD + "def f(x: float, y: float) -> float:\n    return helper(x)\n")
