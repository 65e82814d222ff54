"""Packages of a folder that launch files name otherwise than they are called."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable

_FEWEST = 3  # files: one or two, such as launch/bringup.launch, are in many packages
_SHARE = 0.8  # of them: some were removed since


def find_renamed(
    package: str, paths: Collection[str], here: Iterable[str], has_file: Callable[[str, str], bool]
) -> str:
    """Find the one package that is `package` under another name; "" where none or several may be.

    Its name differs only in capitals and dashes, or it has the files that launch files expect in `package`: `paths`
    below the package's folder. `has_file` says whether a package has a path.
    """
    names = tuple(here)
    if like := [name for name in names if _plain(name) == _plain(package)]:
        return like[0] if len(like) == 1 else ""
    if len(paths) < _FEWEST:
        return ""
    fitting = [name for name in names if sum(has_file(name, path) for path in paths) >= _SHARE * len(paths)]
    return fitting[0] if len(fitting) == 1 else ""


def _plain(name: str) -> str:
    return name.lower().replace("_", "").replace("-", "")
