"""The folder of a new part outside the package, from which `resilin build` makes FMUs."""

from __future__ import annotations

import keyword
import shutil
from pathlib import Path

from .outside import forbidden
from .sources import BuildError

TEMPLATE = Path(__file__).parent / "template"
FILES = {
    "__init__.py.txt": "__init__.py",
    "physics.py.txt": "physics.py",
    "slave.py.txt": "slave.py",
    "README.md": "README.md",
    "reference.csv": "reference.csv",
    "test_part.py.txt": "test_{name}.py",
}
ICONS = ("icon.svg", "icon.png")
"""Files of the template and their names in the folder."""


def new_part(name: str, into: Path) -> Path:
    """Write the folder `into/name`: a spring that hardens, to be replaced by other physics.

    `BuildError` where the name cannot be one, or the folder is there already.
    """
    if not name.isidentifier() or keyword.iskeyword(name) or name != name.lower():
        raise BuildError(
            f"{name!r} cannot name a part: use small letters, underscores and digits after them"
        )
    if reason := forbidden(name):
        raise BuildError(f"{name!r} {reason}: choose another name")
    folder = into / name
    try:
        folder.mkdir(parents=True)
        for source, target in FILES.items():
            text = (TEMPLATE / source).read_text(encoding="utf-8")
            shown = text.replace("NAME", name).replace("CLASS", _class(name))
            (folder / target.format(name=name)).write_text(shown, encoding="utf-8")
        for icon in ICONS:
            shutil.copyfile(TEMPLATE / icon, folder / icon)
    except FileExistsError:
        raise BuildError(f"{folder} is there already: choose another name or folder") from None
    except OSError as error:
        raise BuildError(f"{folder}: cannot be written ({error.strerror})") from None
    return folder


def _class(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_")) or "Own"
