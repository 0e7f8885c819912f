"""Run what the pages show and put in what came out.

    python docs/refresh.py                     the README, all pages and their pictures
    python docs/refresh.py README.md docs/getting-started.md
    python docs/refresh.py --check             run everything, write nothing

The parts have to be built. Comments in a page mark its fenced blocks; each block runs in a folder
of the page's own that holds the built parts and `docs/`:

    <!-- file: slower.toml -->     the block is written to that file
    <!-- run -->                   the block, sh or python, is run and has to leave with exit code 0
    <!-- run: exit code 2 -->      or with that one
    <!-- output -->                the block is replaced by what the last one printed
    <!-- commands -->              what stands from here to `<!-- end -->` is replaced by a table of
                                   all commands and their options

A block without a mark is not touched.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
BUILT = ROOT / "build"
PATIENCE = 300.0
"""Longest that one block may run [s]."""

BLOCK = re.compile(
    r"^<!-- (?P<mark>file|run|output)(?:: (?P<more>[^\n]*?))? -->\n"
    r"(?P<open>```(?P<kind>\w*)\n)(?P<text>.*?)(?P<close>^```$)",
    re.M | re.S,
)
COMMANDS = re.compile(r"(?<=^<!-- commands -->\n).*?(?=^<!-- end -->$)", re.M | re.S)


class PageError(Exception):
    """A block of a page that does not do what its mark says."""


@dataclass(frozen=True)
class Block:
    """A marked block of a page: what to do with it, and the text between its fences."""

    mark: str
    more: str
    kind: str
    text: str
    line: int


def blocks(page: str) -> Iterator[Block]:
    """Marked blocks of a page in their order."""
    for found in BLOCK.finditer(page):
        line = page.count("\n", 0, found.start()) + 1
        yield Block(found["mark"], found["more"] or "", found["kind"], found["text"], line)


def pages() -> list[Path]:
    """Every page that has a marked block."""
    every = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    return [
        path
        for path in every
        if BLOCK.search(text := path.read_text(encoding="utf-8")) or COMMANDS.search(text)
    ]


def prepare(folder: Path, built: Path) -> None:
    """Put into a page's folder what its commands expect there.

    `built` holds the parts, or folders of them for each kind, as `build/` does.
    """
    kinds = [path for path in (built / "fmus", built / "native") if path.is_dir()]
    for kind in kinds or [built]:
        library = folder / "build" / (kind.name if kinds else "fmus")
        library.mkdir(parents=True)
        for path in kind.glob("*.fmu"):
            shutil.copy(path, library)
    (folder / "docs").symlink_to(ROOT / "docs")


def ran(block: Block, folder: Path) -> str:
    """What a block printed, both streams in one; `PageError` where its exit code is another."""
    if block.kind not in {"sh", "python"}:
        raise PageError(f"line {block.line}: a block of {block.kind or 'no kind'} cannot be run")
    wanted = int(block.more.removeprefix("exit code ") or 0)
    command = ["bash", "-e", "-c"] if block.kind == "sh" else [sys.executable, "-c"]
    environment = {
        **os.environ,
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "COLUMNS": "80",
        "TERM": "dumb",
    }
    done = subprocess.run(
        [*command, block.text],
        cwd=folder, env=environment, timeout=PATIENCE, encoding="utf-8",
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    if done.returncode != wanted:
        raise PageError(
            f"line {block.line}: exit code {done.returncode} in the place of {wanted}:"
            f" {block.text.strip()}\n{done.stdout[-3000:]}"
        )
    printed = done.stdout.replace(f"{ROOT}{os.sep}", "").strip("\n")
    return "".join(f"{line.rstrip()}\n" for line in printed.split("\n"))


def refreshed(page: str, folder: Path) -> str:
    """The page with each output block replaced by what the block before it printed."""
    printed: str | None = None
    pieces: list[str] = []
    end = 0
    for block, found in zip(blocks(page), BLOCK.finditer(page), strict=True):
        if block.mark == "file":
            path = folder / block.more
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, encoding="utf-8")
        elif block.mark == "run":
            printed = ran(block, folder)
        elif printed is None:
            raise PageError(f"line {block.line}: an output before anything has run")
        else:
            pieces += [page[end : found.start("text")], printed]
            end = found.end("text")
    page = "".join([*pieces, page[end:]])
    return COMMANDS.sub(lambda _: f"\n{commands()}\n", page)


def commands() -> str:
    """Every command with its arguments and options, as Markdown."""
    from typer.main import get_command

    from orchestrator.cli import app

    sections = []
    for name, command in _every(get_command(app)):
        about, *rest = re.split(r"\n\s*\n", command.help.replace("\b\n", "").strip())
        options = _builder() if name == "build" else command.params
        details = [text for text in rest if not text.strip().startswith("Example: ")]
        lines = [f"### {name}", "", " ".join(" ".join([about, *details]).split()), ""]
        arguments = [p for p in options if p.param_type_name == "argument"]
        usage = " ".join(["resilin", name, *(_shown(p) for p in arguments), "[OPTIONS]"])
        lines += ["```text", usage, *_examples(rest), "```", ""]
        rows = [_row(p) for p in options if p.name != "help"]
        lines += ["| argument or option | meaning |", "|---|---|", *rows, ""] if rows else []
        sections.append("\n".join(lines))
    return "\n".join(sections)


def _every(group: Any, before: str = "") -> Iterator[tuple[str, Any]]:
    """Every command that is shown, by its words; those of a group in the place of the group."""
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from _every(command, f"{before}{name} ")
        elif not command.hidden:
            yield f"{before}{name}", command


def _builder() -> list[Any]:
    """Arguments and options of `build`, which hands them on."""
    from typer.main import get_command

    import build_fmus

    return list(get_command(build_fmus.builder()).params)


def _shown(argument: Any) -> str:
    name = str(argument.name).strip("_").upper()
    return name if argument.required else f"[{name}]"


def _examples(paragraphs: list[str]) -> Iterator[str]:
    for paragraph in paragraphs:
        text = " ".join(paragraph.replace("\\\n", "").split())
        if text.startswith("Example: "):
            yield text.removeprefix("Example: ")


def _row(parameter: Any) -> str:
    """One line of the table of a command."""
    if parameter.param_type_name == "argument":
        names = _shown(parameter)
    else:
        names = "`, `".join([*parameter.opts, *parameter.secondary_opts])
    about = " ".join((parameter.help or "").split()).replace("|", "\\|")
    return f"| `{names}` | {about} |"


def main(arguments: list[str]) -> None:
    """Refresh the given pages, or all of them and their pictures."""
    check = "--check" in arguments
    chosen = [Path(a).resolve() for a in arguments if a != "--check"]
    failed = False
    for path in chosen or pages():
        page = path.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory(prefix="resilin_docs_") as folder:
            prepare(Path(folder), BUILT)
            try:
                text = refreshed(page, Path(folder))
            except PageError as error:
                print(f"{path}: {error}", file=sys.stderr)
                failed = True
                continue
        if not check:
            path.write_text(text, encoding="utf-8")
        print(path.relative_to(ROOT))
    if not (check or chosen):
        subprocess.run([sys.executable, ROOT / "docs" / "images" / "make.py"], check=True)
    if failed:
        raise SystemExit(1)


if __name__ == "__main__":
    main(sys.argv[1:])
