"""The schemas of FMI that come with fmpy: what a description does against them, as warnings.

What wiring and running need is checked by what reads it, in `checks`, `fmi2` and `fmi3`. All
else may be as it is: tools write dates, attributes and orders of elements that no schema allows.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from ...errors import printable
from .findings import Findings

MOST_LINED = 5000


@functools.cache
def _schema(version: str) -> Any:
    """The schema of an FMI version that comes with fmpy."""
    import fmpy
    from lxml import etree

    folder = Path(fmpy.__file__).parent / "schema"
    names = {"2.0": "fmi2/fmi2ModelDescription.xsd", "3.0": "fmi3/fmi3ModelDescription.xsd"}
    return etree.XMLSchema(file=str(folder / names[version]))


def against_schema(root: Any, text: bytes, version: str, findings: Findings) -> None:
    """Add violations of the schema, with lines where the document is of a usual size.

    Collecting all faults takes quadratic time in their number; a parser that validates
    stops at the first, but does not give its line.
    """
    from lxml import etree

    variables = root.find("ModelVariables")
    if variables is not None and len(variables) > MOST_LINED:
        parser = etree.XMLParser(schema=_schema(version), resolve_entities=False, no_network=True)
        try:
            etree.fromstring(text, parser)
        except etree.XMLSyntaxError as error:
            findings.warn("unknown", printable(str(error)))
        return
    schema = _schema(version)
    if not schema.validate(root):
        for entry in schema.error_log:
            findings.warn(entry.line, printable(entry.message))
