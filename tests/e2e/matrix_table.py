"""What each program shows on each base: the table `matrix.yaml`, read and worked out for one base."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from ur.launchfile.world.system import SystemWorld
from ur.request.bases.base_argument import Need, describe_base, list_lacks, read_needs
from ur.request.programs import PACKAGE, Program, find_launch_file, list_programs
from ur.robot.base import Base, list_bases, list_variants, load_base

TABLE = Path(__file__).with_name("matrix.yaml")
_PLACE = re.compile(r"\{([\w.]+)\}")
_TOPIC_KEYS = {"needs", "each", "rate", "per", "at_least", "stamped"}


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic: `rate` is what is expected, in messages a second; None: one message at least.

    `at_least`: more is fine. `stamped`: messages begin with a header, by whose stamps the rate is measured.
    """

    name: str
    rate: float | None = None
    at_least: bool = False
    stamped: bool = True


@dataclass(frozen=True, slots=True)
class Cell:
    """A program on a base. `lacks` is what the base would need to have; where it is not empty, nothing else counts.

    `root` is the root of the tree of frames, `frames` some that are in it. What is said on standard error and holds one
    of `may_say` is expected. `{folder}` in an argument stands for a folder of the cell's own, `{fiducial_map}` for a
    file in it that holds the fiducials of the office.
    """

    program: Program
    base: Base
    lacks: tuple[Need, ...] = ()
    arguments: tuple[str, ...] = ()
    topics: tuple[Topic, ...] = ()
    root: str = "odom"
    frames: tuple[str, ...] = ()
    may_say: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """For people and for pytest: `keyboard_drive-magni:lidar`."""
        return f"{self.program.name}-{describe_base(self.base)}"


def list_all_bases(package: Path = PACKAGE) -> tuple[Base, ...]:
    """Every base of a package, each followed by its variants."""
    return tuple(
        load_base(package, name, variant)
        for name in list_bases(package)
        for variant in ("", *list_variants(package, name))
    )


def load_cells(bases: Sequence[Base], table: Path = TABLE, package: Path = PACKAGE) -> tuple[Cell, ...]:
    """Every program on every base, program by program. Fails for a program that the table leaves out."""
    whole = yaml.safe_load(table.read_text(encoding="utf-8"))
    groups, rows = whole["groups"], whole["programs"]
    programs = {program.name: program for program in list_programs(package / "bin")}
    assert sorted(rows) == sorted(programs), f"{table.name} is not about the programs that there are"
    return tuple(make_cell(program, base, rows[name], groups) for name, program in programs.items() for base in bases)


def make_cell(program: Program, base: Base, row: Mapping[str, Any], groups: Mapping[str, Any]) -> Cell:
    """One program on one base, by its row of the table."""
    path = find_launch_file(program)
    lacks = list_lacks(base, read_needs(str(path), SystemWorld({}))) if path else ()
    wanted = [] if lacks else [groups[name] for name in row["groups"]]
    frames = [name for group in wanted for name, _, _ in _expand(group["frames"], base)]
    return Cell(
        program=program,
        base=base,
        lacks=lacks,
        arguments=tuple(row.get("arguments", ())),
        topics=tuple({topic.name: topic for group in wanted for topic in _topics(group["topics"], base)}.values()),
        root=row.get("root", "odom"),
        frames=tuple(dict.fromkeys(frames)),
        may_say=tuple(row.get("may_say", ())),
    )


def _topics(entries: Mapping[str, Any], base: Base) -> Iterator[Topic]:
    for name, entry, item in _expand(entries, base):
        assert set(entry) <= _TOPIC_KEYS, f"{name}: {entry}"
        rate = entry.get("rate")
        if isinstance(rate, str):
            rate = look_up(base, rate, item)
        if rate is not None and "per" in entry:
            rate *= len(look_up(base, entry["per"], item))
        yield Topic(
            "/" + name,
            None if rate is None else float(rate),
            at_least=entry.get("at_least", False),
            stamped=entry.get("stamped", True),
        )


def _expand(entries: Mapping[str, Any], base: Base) -> Iterator[tuple[str, Mapping[str, Any], Any]]:
    """Names with the base's values in them, their entries, and the item that the entry is about."""
    for name, entry in entries.items():
        if "needs" in entry and not getattr(base, entry["needs"], None):
            continue
        for item in look_up(base, entry["each"]) if "each" in entry else [None]:
            yield _PLACE.sub(lambda match: str(look_up(base, match.group(1), item)), name), entry, item  # noqa: B023 - used at once


def look_up(base: Base, path: str, each: Any = None) -> Any:
    """The value that a dotted path leads to: from the base, or from the item `each`."""
    names = path.split(".")
    value: Any = base
    if names[0] == "each":
        value, names = each, names[1:]
    for name in names:
        value = getattr(value, name)
    return value
