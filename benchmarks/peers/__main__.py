"""`python benchmarks/peers`: the folder is a package, whose parent is put on the path."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from peers.cli import main

if __name__ == "__main__":
    import typer

    typer.run(main)
