"""Execution of a plan of `ur get`, removal of installed packages, and offers to get what a launch file lacks."""

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ur.get.missing import is_installed
from ur.get.record import InstallRecord, load_record, record_path, store_record
from ur.get.steps import PACKAGE_NAME, GetPlan, InstallStep, Missing
from ur.get.tables import parse_simulation
from ur.request.environment import add_own_package, own_packages
from ur.request.requirements.debian_packages import install_debian, list_missing, remove_debian
from ur.request.requirements.python_packages import run_installer
from ur.source.diagnostic import UserError, error
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
        raise UserError(error(message, rule="no-package", help="make room there, then run this again")) from None
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


@dataclass(frozen=True, slots=True)
class InstallActions:
    """The changes to this computer, each of which a test can replace.

    `install` and `remove` take Debian names, `simulate` takes the arguments of apt-get and returns its output,
    `list_missing` returns the names that are not installed, `make_package` builds the package xacro in a folder.
    """

    install: Callable[[Sequence[str]], None] = lambda names: install_debian([names], "what the launch files need")
    remove: Callable[[Sequence[str]], None] = remove_debian
    simulate: Callable[[Sequence[str]], str] = lambda words: simulate_apt(words)
    list_missing: Callable[[Sequence[str]], list[str]] = list_missing
    make_package: Callable[[Path], None] = install_xacro


def install(plan: GetPlan, record: Path, packages: Path, actions: InstallActions | None = None) -> None:
    """Install the Debian and PyPI packages of a plan.

    The packages, with all their dependencies, are recorded first, so that an interrupted installation can be undone.
    After a failure the record has the packages that were installed nevertheless. Raises UserError.
    """
    actions = actions or InstallActions()
    known = before = load_record(record)
    if plan.debian:
        more = parse_simulation(actions.simulate(["install", "--no-install-recommends", *plan.debian]), "Inst")
        new = actions.list_missing(tuple(dict.fromkeys((*plan.debian, *more))))
        known = known.adding(debian=new)
        store_record(known, record)
        try:
            actions.install(plan.debian)
        except BaseException:
            absent = set(actions.list_missing(new)) if new else set()
            with suppress(UserError):  # then the record names more than is installed, which undo skips
                store_record(before.adding(debian=[name for name in new if name not in absent]), record)
            raise
    for step in plan.steps_by("pypi"):
        before, known = known, known.adding(pypi=step.names)
        store_record(known, record)
        try:
            actions.make_package(packages)
        except BaseException:
            with suppress(UserError):
                store_record(before.adding(pypi=[name for name in step.names if (packages / name).is_dir()]), record)
            raise


def undo(record: Path, packages: Path, actions: InstallActions | None = None) -> InstallRecord:
    """Remove the packages that `install` has recorded, and no others; return them.

    Raises UserError, without removing any, if a package installed later needs one of them; or if apt-get fails, with
    the record unchanged.
    """
    actions = actions or InstallActions()
    known = load_record(record)
    absent = set(actions.list_missing(known.debian)) if known.debian else set()
    present = tuple(name for name in known.debian if name not in absent)
    if present:
        goes = parse_simulation(actions.simulate(["remove", *present]), "Remv")
        others = sorted(set(goes) - set(present))
        if others:
            message = f"{', '.join(others[:5])} would be removed as well: they need these packages"
            help_ = f"keep them, or remove that first: apt-get remove {' '.join(others)}"
            raise UserError(error(message, rule="needed-package", help=help_))
        actions.remove(present)
    try:
        for name in known.pypi:
            remove_package(packages / name)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"{problem.filename or packages} cannot be removed: {reason}"
        raise UserError(error(message, rule="unwritable-file")) from None
    store_record(InstallRecord(), record)
    return InstallRecord(present, known.pypi)


def simulate_apt(words: Sequence[str]) -> str:
    """Return the output of `apt-get --simulate`; "" if it fails."""
    try:
        done = subprocess.run(
            ["apt-get", "-q", "--simulate", *words],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "LC_ALL": "C"},
            timeout=120.0,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout


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


def install_xacro_package(environment: Mapping[str, str]) -> None:
    """Build the ROS package xacro, and record it for `ur get --undo`. Raises UserError."""
    plan = GetPlan((InstallStep(Missing("xacro"), "pypi", ("xacro",)),))
    install(plan, record_path(environment), Path(own_packages(environment)))
