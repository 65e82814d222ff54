"""Offers to get packages that a launch file lacks, and xacro, which is installed without a question."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from ur.get.install import install
from ur.get.missing import is_installed
from ur.get.record import record_path
from ur.get.steps import PACKAGE_NAME, GetPlan, InstallStep, Missing
from ur.request.environment import add_own_package, own_packages
from ur.source.suggest import get_command


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
