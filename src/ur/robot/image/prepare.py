"""Conversion of a seed to the files to write into an image, and its removal."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ur.robot.image.layout import SEED_FOLDER, Layout, Scheme, find_layout
from ur.robot.image.seed import MARK, SeedFile
from ur.robot.image.volume import Volume
from ur.robot.robot_file import ROBOT_FILE

ORIGINAL = ".orig"
_NAMES = ("network-config", "ssh", "meta-data", "user-data")  # user-data last: a seed without it is ignored


@dataclass(frozen=True, slots=True)
class Write:
    """A file to write into an image: its present and its future content; None if the file does not exist."""

    volume: Literal["boot", "root"]
    path: str
    before: bytes | None
    after: bytes | None


def seed_places(layout: Layout) -> tuple[tuple[Literal["boot", "root"], str], ...]:
    """Return the paths of all files that a seed may have in such an image, in the order of writing."""
    if layout.scheme is Scheme.CUSTOM_TOML:
        return (("root", str(ROBOT_FILE).lstrip("/")), ("boot", "custom.toml"))
    if layout.scheme is Scheme.ROOT_SEED:
        return tuple(("root", f"{SEED_FOLDER}/{name}") for name in _NAMES if name != "ssh")
    return tuple(("boot", name) for name in _NAMES if name != "ssh" or layout.raspberry)


def read_seed(layout: Layout) -> dict[tuple[str, str], bytes | None]:
    """Read the present state: each path of a seed, and the original file that an earlier seed saved beside it."""
    found: dict[tuple[str, str], bytes | None] = {}
    for volume, path in seed_places(layout):
        for name in (path, path + ORIGINAL):
            found[volume, name] = _volume(layout, volume).read(name)
    return found


def plan_writes(layout: Layout, present: dict[tuple[str, str], bytes | None], seed: Iterable[SeedFile]) -> list[Write]:
    """Plan the files to write for this seed; empty if the seed is already there.

    Original files are kept as NAME.orig.
    """
    wanted = {(file.volume, file.path): file.text.encode() for file in seed}
    return list(_plan(layout, present, wanted))


def _plan(
    layout: Layout,
    present: dict[tuple[str, str], bytes | None],
    wanted: dict[tuple[Literal["boot", "root"], str], bytes],
) -> Iterator[Write]:
    for place in seed_places(layout):
        volume, path = place
        before, original = present[volume, path], present[volume, path + ORIGINAL]
        # A file of an earlier seed that this one lacks: restore the image's original.
        after = wanted.get(place, original if _is_ours(path, before) else before)
        if place in wanted and before not in (None, original) and not _is_ours(path, before):
            yield Write(volume, path + ORIGINAL, original, before)
        if after != before:
            yield Write(volume, path, before, after)
        if place not in wanted and original is not None and _is_ours(path, before):
            yield Write(volume, path + ORIGINAL, original, None)


def plan_undo(layout: Layout, present: dict[tuple[str, str], bytes | None]) -> list[Write]:
    """Plan the changes that remove this project's seed and restore the image's original files."""
    return list(_plan(layout, present, {}))


def write_all(path: Path, writes: Sequence[Write]) -> None:
    """Write files into an image or device. Raises UserError if a file cannot be read back afterwards."""
    layout = find_layout(path)
    for write in writes:
        mode = 0o644 if write.path.endswith(ROBOT_FILE.name) else 0o600  # seeds hold hashes and keys
        _volume(layout, write.volume).write(write.path, write.after, mode)


def _is_ours(path: str, content: bytes | None) -> bool:
    if content is None:
        return False
    head = content[:200].decode(errors="replace")
    return MARK in head or (path.endswith(ROBOT_FILE.name) and "Written by ur" in head)


def _volume(layout: Layout, name: Literal["boot", "root"]) -> Volume:
    volume = layout.boot if name == "boot" else layout.root
    assert volume is not None, "a layout whose scheme has no such file system"
    return volume
