"""Tables of this computer: rosdep's names, apt's packages, and the index of sources, if available."""

import os
import subprocess
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Protocol

from ur.get.index import MAX_INDEX, NEWEST, ROS2, Index, load_sources, merge_indexes, parse_index
from ur.get.plan import Tables, make_plan
from ur.get.steps import DebianPackage, Missing, all_names, parse_candidates, parse_table
from ur.source.diagnostic import user_error
from ur.source.foreign.files import read_text
from ur.source.replace import replace_file
from ur.source.user_folders import user_folder

ROSDEP = Path("/usr/share/python3-rosdep2/debian.yaml")  # of Debian's package python3-rosdep2
INDEX = "https://raw.githubusercontent.com/ros/rosdistro/master/{}/distribution.yaml"
DISTRIBUTIONS = (
    NEWEST,
    "melodic",
    "lunar",
    "kinetic",
    "jade",
    "indigo",
    "hydro",
    "groovy",
)  # a package that left ROS is in the index that had it last
_SECONDS = 20.0


class PackageSources(Protocol):
    """Texts and facts from which a plan is made. Missing ones are not an error."""

    def read_rosdep(self) -> tuple[str, str]:
        """Return the text of rosdep's table, and a note; the text is "" if there is none."""
        ...

    def read_indexes(self, names: Sequence[str], /) -> tuple[tuple[tuple[str, str], ...], str]:
        """Return the names of these distributions and the texts of their indexes, in order, and a note.

        The name is "" for noetic and for requested indexes, which replace DISTRIBUTIONS.
        """
        ...

    def show_candidates(self, names: Sequence[str], /) -> Mapping[str, DebianPackage] | None:
        """Return the Debian packages, of these, that apt can install; None without apt."""
        ...

    def list_installed(self, names: Sequence[str], /) -> frozenset[str]:
        """Return the Debian packages, of these, that are installed."""
        ...


def load_tables(
    missing: Iterable[Missing], sources: PackageSources, distribution: str = "", names: Iterable[str] = ()
) -> tuple[Tables, tuple[str, ...]]:
    """Read the tables for these packages, and return them with notes on missing ones. No package name is sent anywhere.

    Indexes are read only if a package needs them. `names` are the installed packages, for suggestions. Raises UserError
    if a requested index cannot be read.
    """
    wanted = tuple(missing)
    packages = [each.package for each in wanted]
    notes = []
    text, note = sources.read_rosdep()
    rosdep: dict[str, tuple[str, ...]] = {}
    try:
        rosdep = parse_table(text) if text else {}
    except ValueError as problem:
        note = f"rosdep's table cannot be used: {problem}"
    notes += [note] if note else []
    debian = all_names(packages, rosdep, distribution)
    tables = Tables(rosdep, sources.show_candidates(debian), sources.list_installed(debian), None, distribution)
    if make_plan(wanted, tables, bool).steps_by("unknown"):
        tables = replace(tables, known=load_sources(), names=frozenset(names))
        index, note = _load_index(sources, DISTRIBUTIONS)
        tables = replace(tables, index=index)
        if index is not None and not note and make_plan(wanted, tables, bool).steps_by("unknown"):
            newer, note = _load_index(sources, ROS2)
            tables = replace(tables, ros2=newer)
        notes += [note] if note else []
    return tables, tuple(notes)


def _load_index(sources: PackageSources, names: Sequence[str]) -> tuple[Index | None, str]:
    texts, note = sources.read_indexes(names)
    indexes = []
    for distribution, text in texts:
        index, problem = _parse(text, distribution)
        indexes += [index] if index else []
        note = problem or note
    return merge_indexes(indexes) if indexes else None, note


@lru_cache(maxsize=16)  # a bench asks again for each repository
def _parse(text: str, distribution: str) -> tuple[Index | None, str]:
    try:
        return parse_index(text, distribution), ""
    except ValueError as problem:
        return None, f"the index {distribution or 'of sources'} cannot be used: {problem}"


class ThisComputer:
    """The tables of this computer.

    `files` are indexes to read in place of ROS's own; `offline`: nothing is downloaded.
    """

    def __init__(self, environment: Mapping[str, str], files: Sequence[str] = (), *, offline: bool = False) -> None:
        self._cache = Path(user_folder("XDG_CACHE_HOME", environment)) / "ubiquity_launches"
        self._files = tuple(files)
        self._offline = offline

    def read_rosdep(self) -> tuple[str, str]:
        """See PackageSources. The Debian package is unpacked for its table, not installed."""
        kept = self._cache / "rosdep-debian.yaml"
        for path in (ROSDEP, kept):
            if text := _read(path):
                return text, ""
        reason = "it is not here" if self._offline else self._fetch_rosdep(kept)
        if text := _read(kept):
            return text, ""
        return "", f"without rosdep's table (python3-rosdep2: {reason}) only apt's names were compared"

    def read_indexes(self, names: Sequence[str]) -> tuple[tuple[tuple[str, str], ...], str]:
        """See PackageSources. Raises UserError if a requested file cannot be read."""
        if self._files:
            return tuple(("", _read_given(path)) for path in self._files if names[0] == NEWEST), ""
        found: list[tuple[str, str]] = []
        for name in names:
            kept, address = self._cache / f"{name}.yaml", INDEX.format(name)
            text = _read(kept)
            if not text:
                try:
                    text = "" if self._offline else _download(address)
                except (OSError, ValueError) as problem:
                    reason = getattr(problem, "reason", problem)
                    note = f"no index of sources: {address} cannot be fetched ({reason}); --index FILE reads one"
                    return tuple(found), note
                if text:
                    _keep(kept, text)
            if text:
                found.append((name if name != NEWEST else "", text))
        return tuple(found), ""

    def show_candidates(self, names: Sequence[str]) -> Mapping[str, DebianPackage] | None:
        if not names:
            return {}
        text = _output(["apt-cache", "show", "--no-all-versions", *names])
        return None if text is None else parse_candidates(text)

    def list_installed(self, names: Sequence[str]) -> frozenset[str]:
        if not names:
            return frozenset()
        text = _output(["dpkg-query", "--show", "--showformat=${Package} ${db:Status-Status}\n", *names]) or ""
        return frozenset(line.split()[0] for line in text.splitlines() if line.endswith(" installed"))

    def _fetch_rosdep(self, kept: Path) -> str:
        # Returns why it could not be had.
        with tempfile.TemporaryDirectory(prefix="ur-get-") as folder:
            if _output(["apt-get", "-q", "download", "python3-rosdep2"], folder, strict=True) is None:
                return "apt cannot fetch it"
            for package in Path(folder).glob("python3-rosdep2_*.deb"):
                if _output(["dpkg-deb", "-x", str(package), f"{folder}/all"], strict=True) is None:
                    return "dpkg cannot read it"
            text = _read(Path(f"{folder}/all{ROSDEP}"))
        if not text:
            return "it has no table"
        _keep(kept, text)
        return ""


def _read_given(name: str) -> str:
    try:
        return read_text(Path(name).expanduser(), MAX_INDEX)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"index {name!r} cannot be read: {reason}, expected a distribution.yaml"
        raise user_error(message, rule="no-index", help=f"get it from {INDEX.format(DISTRIBUTIONS[0])}") from None


def _download(address: str) -> str:
    from urllib.request import urlopen

    if not address.startswith("https://"):
        raise ValueError("expected an https address")
    with urlopen(address, timeout=_SECONDS) as answer:  # noqa: S310 - https only
        return str(answer.read(MAX_INDEX).decode("utf-8", "replace"))


def _read(path: Path) -> str:
    try:
        return read_text(path, MAX_INDEX)
    except OSError:
        return ""


def _keep(path: Path, text: str) -> None:
    # A cache: where it cannot be written, the next call fetches the text again.
    try:
        replace_file(path, text, parents=True, lasting=False)
    except OSError:
        return


def _output(command: Sequence[str], folder: str | None = None, *, strict: bool = False) -> str | None:
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
            cwd=folder,
            env={**os.environ, "LC_ALL": "C"},
            timeout=60.0,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return None if strict and done.returncode else done.stdout
