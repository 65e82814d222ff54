"""Execution of a plan of `ur get`, and removal of the installed packages."""

import os
import subprocess
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ur.get.record import InstallRecord, load_record, store_record
from ur.get.steps import GetPlan
from ur.get.tables import parse_simulation
from ur.get.xacro import install_xacro, remove_package
from ur.request.requirements.debian_packages import install_debian, list_missing, remove_debian
from ur.source.diagnostic import UserError, error


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
