"""The error for a package.xml that ROS does not accept, apart because it takes long to load and is seldom needed."""

from __future__ import annotations

from ur.source.diagnostic import UserError, error_about


class BrokenPackageError(UserError, ValueError):
    """A package.xml cannot be used, so that rospack refuses to search packages. Its text begins with the path."""


def broken_package(path: str, reason: object) -> BrokenPackageError:
    """Return the error for a package.xml that is not one for this reason."""
    help_ = "correct this file, or take its folder out of ROS_PACKAGE_PATH"
    return BrokenPackageError(error_about(path, str(reason), rule="broken-package", help=help_))
