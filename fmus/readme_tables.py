"""Tables of a part's ports and parameters for its README, made from the code.

    python -m fmus.readme_tables            rewrite the tables in all READMEs of `fmus/`
    python -m fmus.readme_tables ./mine     the same in the folder of a part of one's own

The tables stand between the marks `<!-- ports -->`, `<!-- parameters -->` and
`<!-- end -->`; a test holds them to the code.
"""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path

from .part import Part, Variable

HERE = Path(__file__).parent


def load(name: str) -> Part:
    """The part in a folder of `fmus/`."""
    part: Part = importlib.import_module(f"{__package__}.{name}.slave").PART
    return part


def names() -> list[str]:
    """Parts that have a README."""
    return sorted(path.parent.name for path in HERE.glob("*/README.md"))


def _row(*cells: str) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _range(variable: Variable) -> str:
    least, most = variable.quantity.least, variable.quantity.most
    if variable.quantity.choices:
        return ", ".join(variable.quantity.choices)
    if least is None and most is None:
        return ""
    low = "" if least is None else f"{least:g}"
    high = "" if most is None else f"{most:g}"
    return f"{low} ... {high}".strip()


def parameters(part: Part) -> str:
    """Parameters with unit, default, range and provenance."""
    rows = [_row("parameter", "unit", "default", "range", "meaning", "provenance")]
    rows.append("|---|---|---|---|---|---|")
    for v in part.variables:
        if v.causality == "parameter":
            q = v.quantity
            default = q.choices[int(v.start) - 1] if q.choices else f"{v.start:g}"
            rows.append(_row(f"`{v.name}`", q.unit, default, _range(v), q.meaning, q.source))
    return "\n".join(rows)


def ports(part: Part) -> str:
    """Inputs and outputs with unit, order in the law and meaning."""
    rows = [_row("variable", "direction", "unit", "law", "meaning"), "|---|---|---|---|---|"]
    kinds = ("value", "affine", "curvature")
    for v in part.variables:
        if v.causality != "parameter":
            law = kinds[v.quantity.order] if v.quantity.port else ""
            rows.append(_row(f"`{v.name}`", v.causality, v.quantity.unit, law, v.quantity.meaning))
    return "\n".join(rows)


def filled(text: str, part: Part) -> str:
    """README text with the tables between its marks as the code has them."""
    for mark, table in (("ports", ports(part)), ("parameters", parameters(part))):
        pattern = rf"(<!-- {mark} -->\n).*?(<!-- end -->)"
        parts = re.split(pattern, text, flags=re.S)
        text = parts[0] + "".join(
            f"{opened}{table}\n{closed}{rest}"
            for opened, closed, rest in zip(parts[1::3], parts[2::3], parts[3::3], strict=True)
        )
    return text


def _rewrite(readme: Path, part: Part) -> None:
    readme.write_text(filled(readme.read_text(encoding="utf-8"), part), encoding="utf-8")


if __name__ == "__main__":
    from .export.outside import outside_part

    for folder in map(Path, sys.argv[1:]):
        _rewrite(folder / "README.md", outside_part(folder))
    for name in names() if len(sys.argv) == 1 else []:
        _rewrite(HERE / name / "README.md", load(name))
