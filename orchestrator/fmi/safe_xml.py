"""XML of foreign files: no entities, no DOCTYPE, no network, bounded nesting, no comments."""

from __future__ import annotations

from typing import Any

from ..errors import FmuError, printable

DEEPEST = 64
CODES = ("utf-8", "utf-16-le", "utf-16-be", "utf-32-le", "utf-32-be")


def guarded(where: str, text: bytes) -> Any:
    """Root element of a document; `where` begins the message of the `FmuError` if it is refused."""
    from lxml import etree

    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(text, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        doctype = any("<!DOCTYPE".encode(code) in text for code in CODES)
        reason = "has a DOCTYPE: refused" if doctype else f"is not XML: {printable(str(error))}"
        raise FmuError(f"{where} {reason}") from None
    document: Any = root.getroottree().docinfo
    if document.internalDTD is not None or document.doctype:
        raise FmuError(f"{where} has a DOCTYPE: refused")
    depth = 0
    for event, _ in etree.iterwalk(root, events=("start", "end")):
        depth += 1 if event == "start" else -1
        if depth > DEEPEST:
            raise FmuError(f"{where} is nested deeper than {DEEPEST}")
    return root
