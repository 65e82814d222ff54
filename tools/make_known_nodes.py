"""Make the table of this library's nodes, and of the sources of velocity commands, from where they are declared.

The heads of the executables `ubiquity_launches/n_*/bin/*` have lines `##Subscribes:`, `##Publishes:`, `##Offers:`,
`##Calls:`, `##Actions:` and `##Uses:`, which name topics, services and actions in backticks and go on in lines that
begin with `## `. A note in parentheses may follow a name; with the word `where` the name is published on some robots
only. `params/sources.yaml` in backticks stands for the topics of that file.

They become `ur.launchfile.query.library_nodes`, and the table of sources in docs/reference/mux.md; a test compares.
"""

import re
import textwrap
from collections.abc import Iterator
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[1]
LIBRARY = ROOT / "ubiquity_launches"
SOURCES = LIBRARY / "n_cmd_vel_mux/params/sources.yaml"
MODULE = ROOT / "src/ur/launchfile/query/library_nodes.py"
PAGE = ROOT / "docs/reference/mux.md"
HEADINGS = {
    "Publishes": "publishes",
    "Subscribes": "subscribes",
    "Offers": "services",
    "Calls": "calls",
    "Actions": "actions",
    "Uses": "uses",
}
_HEADING = re.compile(r"##(\w+):\s*(.*)")
_NAME = re.compile(r"`([^`]+)`\s*(\((?:[^()]|\([^()]*\))*\))?")
_MODULE = '''"""Topics, services and actions of this library's nodes. Made by tools/make_known_nodes.py."""

from ur.launchfile.query.arguments import Interface, make_interface

LIBRARY_NODES: dict[str, Interface] = {
'''


def read_heads() -> dict[str, dict[str, str]]:
    """The declarations of the library's nodes: texts by heading, by executable."""
    heads = {path.name: read_head(path.read_text(encoding="utf-8")) for path in sorted(LIBRARY.glob("n_*/bin/*"))}
    return {name: head for name, head in heads.items() if head}


def read_head(text: str) -> dict[str, str]:
    """The texts of the headings above in the text of an executable."""
    found: dict[str, str] = {}
    current = ""
    for line in text.splitlines():
        heading = _HEADING.match(line)
        if heading:
            current = heading[1]
            found[current] = heading[2].strip()
        elif line.startswith("## ") and current:
            found[current] += f" {line[3:].strip()}"
        else:
            current = ""
    return {name: each for name, each in found.items() if name in HEADINGS}


def list_names(text: str, *, certain: bool) -> list[str]:
    """The names in a declaration, without those with a placeholder, and, if `certain`, those of some robots."""
    names: list[str] = []
    for name, note in _NAME.findall(text):
        if name == "params/sources.yaml":
            names += list_source_topics()
        elif "<" not in name and not (certain and "where" in note):
            names.append(name.removeprefix("/"))
    return list(dict.fromkeys(names))


def list_source_topics() -> list[str]:
    """The topics of the library's sources of velocity commands, and of its locks."""
    given = yaml.safe_load(SOURCES.read_text(encoding="utf-8"))
    topics = [each["topic"] for each in given["topics"]]
    return [name for topic in topics for name in (topic, f"{topic}_stamped")] + [e["topic"] for e in given["locks"]]


def make_module() -> str:
    """The table of interfaces, as a module."""
    rows = []
    for executable, head in read_heads().items():
        if arguments := list(_arguments(head)):
            joined = " ".join(map(str.strip, arguments)).removesuffix(",")
            row = f'    "{executable}": make_interface({joined}),'
            whole = all(each.endswith(",") for each in arguments)
            inner = [f"        {joined}"] if whole and len(joined) <= 112 else arguments
            rows += [row] if whole and len(row) <= 120 else [row.partition(joined)[0], *inner, "    ),"]
    return _MODULE + "\n".join(rows) + "\n}\n"


def _arguments(head: dict[str, str]) -> Iterator[str]:
    for heading, field in HEADINGS.items():
        names = list_names(head.get(heading, ""), certain=heading == "Publishes")
        if names:
            first, *more = textwrap.wrap(" ".join(names), 90, break_long_words=False, break_on_hyphens=False)
            parts = [f'{field}="{first}', *(f'"{each}' for each in more)]
            yield from (f'        {part} "' for part in parts[:-1])
            yield f'        {parts[-1]}",'


def make_page(text: str) -> str:
    """The page of the mux with the table of sources."""
    given = yaml.safe_load(SOURCES.read_text(encoding="utf-8"))
    comments = dict(re.findall(r"name: (\w+) # sent by (.+)", SOURCES.read_text(encoding="utf-8")))
    rows = [
        "| source | topic | priority | ignored when older than | sent by |",
        "|---|---|---|---|---|",
        "| emergency stop | `~stop`, `~release` | above all | never "
        "| the space bar, the joystick's button, any program |",
    ]
    for each in sorted(given["topics"], key=lambda item: -item["priority"]):
        name, topic = each["name"], each["topic"]
        rows.append(
            f"| {name} | `{topic}`, `{topic}_stamped` | {each['priority']} | {each['timeout']} s | {comments[name]} |"
        )
    return _replace_table(text, "| source | topic |", rows)


def _replace_table(text: str, start: str, rows: list[str]) -> str:
    lines = text.splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith(start))
    end = next(number for number in range(first, len(lines) + 1) if number == len(lines) or lines[number][:1] != "|")
    return "\n".join([*lines[:first], *rows, *lines[end:]]) + "\n"


FILES = {
    MODULE: lambda _: make_module(),
    PAGE: make_page,
}

if __name__ == "__main__":
    for place, make in FILES.items():
        place.write_text(make(place.read_text(encoding="utf-8") if place.exists() else ""), encoding="utf-8")
