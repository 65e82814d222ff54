"""Packages of a folder that launch files name otherwise than they are called."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable

_FEW = 3  # files: of fewer all have to be there
_SHARE = 0.8  # of more: some were removed since


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
    least = len(paths) * (_SHARE if len(paths) >= _FEW else 1)
    fitting = [name for name in names if paths and sum(has_file(name, path) for path in paths) >= least]
    return fitting[0] if len(fitting) == 1 else ""


def _plain(name: str) -> str:
    return name.lower().replace("_", "").replace("-", "")
