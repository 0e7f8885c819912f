"""A foreign FMU whose description is written as other tools write theirs."""

from __future__ import annotations

import zipfile
from pathlib import Path

DESCRIPTION = "modelDescription.xml"


def rewritten(
    fmu: Path, target: Path, *changes: tuple[str, str], library: str = "", platform: str = ""
) -> Path:
    """A copy of an FMU with texts of its description replaced, each of which must be there.

    `library` renames its shared library, without the suffix, `platform` the folder of that.
    """
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            content = old.read(name)
            if name == DESCRIPTION:
                text = content.decode()
                for before, after in changes:
                    assert before in text, before
                    text = text.replace(before, after)
                content = text.encode()
            else:
                path = Path(name)
                file = (library or path.stem) + path.suffix
                name = f"binaries/{platform or path.parent.name}/{file}"
            new.writestr(name, content)
    return target
