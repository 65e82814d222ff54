"""Repositories that the files of a folder name: lists of vcstool and wstool, submodules, `git clone` in its texts."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.resources import files

import yaml

from ur.get.index import make_repository
from ur.get.model import Repository

LISTS = re.compile(r"\.gitmodules|.*\.repos|.*\.rosinstall(\..*)?")
TEXTS = re.compile(r"readme.*|.*\.md|.*\.rst|dockerfile.*|.*\.sh|\.travis\.yml", re.IGNORECASE)
_CLONE = re.compile(r"\bgit\s+clone\s+(?P<options>(?:-\S+\s+(?:(?!https?:)\S+\s+)?)*)(?P<url>https://[\w.@:~%+/-]+)")
_BRANCH = re.compile(r"(?:-b|--branch)[\s=]+(\S+)")
_MODULE = re.compile(r"^\s*url\s*=\s*(https://\S+)\s*$", re.MULTILINE)
_ROS = re.compile(r"^ros_|_(ros|ros_pkg|ros_pkgs|ros1)$")  # what is added to the name of what a repository is for
_SHORTEST = 5  # letters of a stem that is more than a common word


def read_hints(name: str, text: str) -> Iterator[Repository]:
    """The repositories that a file of this name lists. Entries that cannot be used are left out."""
    if name == ".gitmodules":
        yield from _cloned((each, "") for each in _MODULE.findall(text))
    elif LISTS.fullmatch(name):
        yield from _listed(text)
    elif TEXTS.fullmatch(name):
        found = ((each["url"], _BRANCH.search(each["options"])) for each in _CLONE.finditer(text))
        yield from _cloned((url, branch[1] if branch else "") for url, branch in found)


def find_hint(package: str, hints: Iterable[Repository]) -> Repository | None:
    """The repository that has the name of a package, with "ros" or without."""
    wanted = _plain(package)
    return next((hint for hint in hints if wanted in (_plain(hint.name), _stem(hint))), None)


def find_related_hint(package: str, hints: Iterable[Repository]) -> Repository | None:
    """The repository whose name, without "ros", begins the package's; of several the longest counts."""
    fitting = [
        hint
        for hint in hints
        if _stem(hint) != _plain(hint.name)
        and len(_stem(hint)) >= _SHORTEST
        and _plain(package).startswith(f"{_stem(hint)}_")
    ]
    return max(fitting, key=lambda hint: len(_stem(hint)), default=None)


def parse_sources(text: str) -> dict[str, Repository]:
    """Read a table of repositories (see known_sources.tsv): by package. Raises ValueError, which names the line."""
    found: dict[str, Repository] = {}
    rows = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line and not line.startswith("#")]
    for number, line in rows[1:]:
        cells = line.split("\t")
        url, branch, packages = cells if len(cells) == 3 else ("", "", "")
        repository = _clone(url, "" if branch == "-" else branch)
        if repository is None or not packages:
            raise ValueError(f"known_sources.tsv:{number}: expected an address, a branch or -, and packages")
        found.update(dict.fromkeys(packages.split(), repository))
    return found


@cache
def load_sources() -> dict[str, Repository]:
    """The table of repositories that no index of ROS holds."""
    return parse_sources((files(__package__) / "known_sources.tsv").read_text(encoding="utf-8"))


def _listed(text: str) -> Iterator[Repository]:
    try:
        document = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506 - safe loaders
    except (yaml.YAMLError, RecursionError):
        return
    if isinstance(document, dict) and isinstance(document.get("repositories"), dict):  # of vcstool
        for name, source in document["repositories"].items():
            if isinstance(name, str) and (repository := make_repository(_last(name), source)):
                yield repository
    for entry in document if isinstance(document, list) else ():  # of wstool
        for kind, source in entry.items() if isinstance(entry, dict) else ():
            if isinstance(source, dict):
                name = str(source.get("local-name", ""))
                keys = {"type": kind, "url": source.get("uri"), "version": source.get("version")}
                if repository := make_repository(_last(name), keys):
                    yield repository


def _cloned(found: Iterable[tuple[str, str]]) -> Iterator[Repository]:
    for url, branch in found:
        if repository := _clone(url.rstrip(".,"), branch):
            yield repository


def _clone(url: str, branch: str) -> Repository | None:
    return make_repository(_last(url).removesuffix(".git"), {"type": "git", "url": url, "version": branch})


def _last(path: str) -> str:
    return path.rstrip("/").rpartition("/")[2]


def _stem(hint: Repository) -> str:
    return _ROS.sub("", _plain(hint.name))


def _plain(name: str) -> str:
    return name.lower().replace("-", "_")
