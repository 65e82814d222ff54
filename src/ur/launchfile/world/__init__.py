"""Packages, files and environment, behind one Protocol."""

from ur.launchfile.world.memory import MemoryWorld
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.launchfile.world.system import SystemWorld

__all__ = ["MemoryWorld", "PackageNotFound", "SystemWorld", "World"]
