"""The package, or the workspace of a base, that receives new files."""

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from ur.source.diagnostic import user_error
from ur.source.foreign.files import MAX_MANIFEST, read_text
from ur.tools.new.parts import NewFile

_NAME_A_PACKAGE = "change to the folder of a package, name one with --package, or create one: ur new package"


@dataclass(frozen=True, slots=True)
class TargetPackage:
    """The package that receives new files."""

    name: str
    folder: Path


def find_target(place: str | None, help_: str = _NAME_A_PACKAGE) -> TargetPackage:
    """Return the package with a name or folder, or the one around the current folder.

    Raises UserError if there is no such folder or package, or no package around the folder, with the advice `help_`.
    """
    if place is not None and not Path(place).is_dir():
        from ur.launchfile.world.protocol import PackageNotFound
        from ur.launchfile.world.system import SystemWorld
        from ur.request.environment import add_own_package

        try:
            return TargetPackage(place, Path(SystemWorld(add_own_package(os.environ)).find_package(place)))
        except PackageNotFound:
            message = f"no folder or package named '{place}'"
            raise user_error(message, rule="unknown-package", help="create one: ur new package") from None
    start = Path(place or ".").resolve()
    for folder in (start, *start.parents):
        if (folder / "package.xml").is_file():
            named = re.search(r"<name>\s*([\w-]+)\s*</name>", read_text(folder / "package.xml", MAX_MANIFEST))
            return TargetPackage(named.group(1) if named else folder.name, folder)
    raise user_error(f"no package.xml in {start} or its parent folders", rule="no-package", help=help_)


@dataclass(frozen=True, slots=True)
class BaseDestination:
    """The destination of a base: the folder of its files, and the package of the bases that it resembles.

    In a workspace, `prefix` precedes the path of each file, `url` is where RViz finds the files, and `marker` is the
    file that identifies the folder as one; all are empty in a package.
    """

    target: TargetPackage
    library: Path
    prefix: str = ""
    url: str = ""
    marker: tuple[NewFile, ...] = ()

    def place_files(self, files: Iterable[NewFile]) -> list[NewFile]:
        """Return the files at their destination, with the marker of a new workspace."""
        return [*(replace(file, path=f"{self.prefix}{file.path}") for file in files), *self.marker]


def target_of(package: str | None, workspace: str | None) -> BaseDestination:
    """Return the requested destination; by default the package around the current folder. Raises UserError."""
    from ur.request.programs import PACKAGE
    from ur.source.user_folders import MARKER

    if workspace is None:
        help_ = "add --workspace ~/FOLDER, or change to the folder of a package, or name one with --package"
        target = find_target(package, help_)
        return BaseDestination(target, target.folder)
    if package is not None:
        message = "--package and --workspace name two places for the base, expected one of them"
        raise user_error(message, rule="bad-value", help="leave one of them out")
    root = Path(workspace).expanduser().resolve()
    prefix = f"share/{PACKAGE.name}/"
    marker = () if (root / MARKER).exists() else (NewFile(MARKER, ""),)
    return BaseDestination(TargetPackage(PACKAGE.name, root), PACKAGE, prefix, (root / prefix).as_uri(), marker)


def next_step(place: BaseDestination, name: str) -> str:
    """Return the command that uses the new base, whose workspace is remembered."""
    from ur.source.user_folders import remember_workspace

    if place.prefix:
        try:
            remember_workspace(str(place.target.folder), os.environ)
        except OSError:
            return f"export CMAKE_PREFIX_PATH={place.target.folder}:$CMAKE_PREFIX_PATH, then ur use sim:{name}"
    return f"ur use sim:{name}"
