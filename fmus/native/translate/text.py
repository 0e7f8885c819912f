"""C text: literals, comments, and lines that are not too long."""

from __future__ import annotations

import math
import re
import textwrap

WIDTH = 100
STEP = "    "
WORDS = re.compile(
    r'"(?:[^"\\]|\\.)*"|(?P<open>[({[])|(?P<close>[)}\]])|(?P<comma>, )'
    r"|(?P<sign> (?:[-+*/?:]|&&|\|\||[<>=!]=|[<>]) )"
)


def literal(value: float) -> str:
    """A double as C reads it, to the same bits."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "HUGE_VAL" if value > 0.0 else "-HUGE_VAL"
    return repr(float(value))


def quoted(text: str) -> str:
    """A string literal of C with the UTF-8 bytes of a text; no trigraph, no hex run."""
    pieces = []
    for byte in text.encode():
        plain = 32 <= byte < 127 and chr(byte) not in '"\\?'
        pieces.append(chr(byte) if plain else f"\\{byte:03o}")
    return '"' + "".join(pieces) + '"'


def comment(text: str, indent: str = "") -> list[str]:
    """A block comment; what would begin or end one inside it is taken apart."""
    plain = text.strip().replace("*/", "* /").replace("/*", "/ *")
    lines = textwrap.dedent(_unindented(plain)).splitlines()
    if not lines:
        return []
    if len(lines) == 1 and len(lines[0]) + len(indent) + 6 <= WIDTH:
        return [f"{indent}/* {lines[0]} */"]
    body = [f"{indent}   {line}".rstrip() for line in lines[1:]]
    made = [f"{indent}/* {lines[0]}", *body]
    made[-1] += " */"
    return made


def _unindented(text: str) -> str:
    """A docstring without the indentation of its later lines."""
    first, line, rest = text.partition("\n")
    return first + line + textwrap.dedent(rest)


def wrapped(text: str, indent: str) -> list[str]:
    """A statement in lines of at most `WIDTH`, where it can be broken.

    A long record gets a line for each of its fields; all else is broken between words.
    """
    if len(indent) + len(text) <= WIDTH:
        return [indent + text]
    opened = text.find("){.")
    if opened >= 0:
        head, fields, tail = _braces(text, opened + 1)
        made = [f"{indent}{head}{{"]
        for field in fields:
            made += wrapped(f"{field},", indent + STEP)
        return [*made, f"{indent}}}{tail}"]
    return _filled(text, indent)


def _filled(text: str, indent: str) -> list[str]:
    """Lines broken after a comma or before a sign, as far out of the brackets as there is room."""
    made: list[str] = []
    rest = text
    while len(indent) + len(rest) > WIDTH:
        room = WIDTH - len(indent)
        breaks = [(depth, -place) for place, depth in _breaks(rest) if place <= room]
        late = [(depth, place) for depth, place in breaks if -place > room // 3]
        if not breaks:
            break
        place = -min(late or breaks)[1]
        made.append(indent + rest[:place].rstrip())
        rest = rest[place:].lstrip()
        if len(made) == 1:
            indent += STEP
    return [*made, indent + rest]


def _breaks(text: str) -> list[tuple[int, int]]:
    """Places where a line may end, with how many brackets are open there."""
    found = []
    depth = 0
    for word in WORDS.finditer(text):
        if word["open"]:
            depth += 1
        elif word["close"]:
            depth -= 1
        elif word["sign"]:
            found.append((word.start(), depth))
        elif word["comma"]:
            found.append((word.end(), depth))
    return found


def _braces(text: str, start: int) -> tuple[str, list[str], str]:
    """What stands before a brace, its entries, and what follows the brace that closes it."""
    depth = 0
    entries: list[str] = []
    begun = start + 1
    for place in range(start, len(text)):
        letter = text[place]
        if letter in "{([":
            depth += 1
        elif letter in "})]":
            depth -= 1
            if depth == 0:
                entries.append(text[begun:place].strip())
                return text[:start], entries, text[place + 1 :]
        elif letter == "," and depth == 1:
            entries.append(text[begun:place].strip())
            begun = place + 1
    raise AssertionError(f"a brace is not closed: {text}")


def flat(text: str) -> str:
    """A text on one line."""
    return " ".join(text.split())
