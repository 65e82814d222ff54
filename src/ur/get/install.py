"""Execution of a plan of `ur get`, and offers to get what a launch file lacks."""

import os
import shlex
import shutil
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ur.get.missing import is_installed
from ur.get.steps import PACKAGE_NAME, GetPlan
from ur.request.environment import add_own_package
from ur.request.requirements.preparation import install_debian
from ur.request.requirements.python_packages import run_installer
from ur.source.diagnostic import user_error
from ur.source.project import project_folder, state_folder
from ur.source.replace import make_folder, replace_file, sync_folder
from ur.source.suggest import get_command

Run = Callable[[Sequence[str], str, str], None]
_PACKAGE_XML = """\
<package format="2">
  <name>xacro</name>
  <version>2.1.1</version>
  <description>xacro of PyPI, put here by ur get</description>
  <maintainer email="nobody@example.com">nobody</maintainer>
  <license>BSD</license>
</package>
"""
# PyPI's xacro asks ROS 2 where packages are.
_MAIN = """\
import sys

sys.path.insert(0, {library!r})
import xacro
import xacro.substitution_args


def find(name):
    if name == "xacro":
        return {folder!r}
    import rospkg

    return rospkg.RosPack().get_path(name)


xacro.substitution_args._eval_find = find
sys.argv[0] = "xacro"
xacro.main()
"""


def install_xacro(packages: Path, run: Run = run_installer) -> None:
    """Build the package `xacro` in the folder `packages`, completely or not at all. Raises UserError."""
    target, new = packages / "xacro", packages / f".xacro.{os.urandom(4).hex()}.ur-new"
    try:
        make_folder(str(packages))
        new.mkdir()
        _fill(new, target, run)
        remove_package(target)
        new.rename(target)
        sync_folder(str(packages))
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"xacro could not be installed in {packages}: {reason}"
        raise user_error(message, rule="no-package", help="make room there, then run this again") from None
    finally:
        with suppress(OSError):
            shutil.rmtree(new)


def remove_package(folder: Path) -> None:
    """Remove the folder of a package atomically. Raises OSError."""
    replaced = folder.with_name(f".{folder.name}.{os.urandom(4).hex()}.ur-new")
    try:
        folder.rename(replaced)
    except FileNotFoundError:
        return
    shutil.rmtree(replaced)


def _fill(new: Path, target: Path, run: Run) -> None:
    python = state_folder() / ".venv/bin/python"
    lock = project_folder() / "requirements" / "xacro.lock"
    run(
        [
            *(sys.executable, "-I", "-m", "pip", "install", "--disable-pip-version-check", "--progress-bar", "off"),
            *("--require-hashes", "--only-binary", ":all:", "--no-deps", "--no-compile"),
            *("--target", str(new / "lib"), "-r", str(lock)),
        ],
        "xacro",
        "pip's settings (pip config list)",
    )
    with suppress(FileNotFoundError):
        shutil.rmtree(new / "lib/bin")  # pip's own script would be a second program of this name
    replace_file(new / "main.py", _MAIN.format(library=str(target / "lib"), folder=str(target)))
    start = f"#!/bin/sh\nexec {shlex.quote(str(python if python.exists() else Path(sys.executable)))}"
    start += f' -I {shlex.quote(str(target / "main.py"))} "$@"\n'
    for name in ("xacro", "xacro.py"):  # the second is the name in launch files of before 2018
        replace_file(new / name, start, mode=0o775)
    replace_file(new / "package.xml", _PACKAGE_XML)


def install(
    plan: GetPlan,
    packages: Path,
    debian: Callable[[Sequence[Sequence[str]], str], None] = install_debian,
    make_package: Callable[[Path], None] = install_xacro,
) -> None:
    """Install the Debian packages of a plan, and those of PyPI in the folder `packages`. Raises UserError."""
    if plan.debian:
        debian([plan.debian], "what the launch files need")
    if any(plan.steps_by("pypi")):
        make_package(packages)


@dataclass(frozen=True, slots=True)
class PackageOffer:
    """Missing packages that can be searched, sorted."""

    names: tuple[str, ...]

    @property
    def question(self) -> str:
        """Return the question for the terminal."""
        return f"{', '.join(self.names)} {'is' if len(self.names) == 1 else 'are'} missing; find out where to get that?"

    @property
    def help(self) -> str:
        """Return the advice if no question can be asked."""
        command = f"ur get {' '.join(self.names)}" if len(self.names) > 1 else get_command(self.names[0])
        return f"{command} prints how to get what is missing, and asks before it installs"

    def count_installed(self, environment: Mapping[str, str]) -> int:
        """Return the number of these packages that are found."""
        from ur.launchfile.world.system import SystemWorld

        world = SystemWorld(add_own_package(environment))
        return sum(is_installed(name, world) for name in self.names)


def make_offer(names: Iterable[str]) -> PackageOffer | None:
    """Return the offer for missing packages; None if none of them has a valid package name."""
    wanted = tuple(sorted(name for name in names if PACKAGE_NAME.fullmatch(name)))
    return PackageOffer(wanted) if wanted else None
