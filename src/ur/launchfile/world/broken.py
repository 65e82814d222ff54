"""The error for a package.xml that ROS does not accept; a separate module that is slow to import and rarely needed."""

from ur.source.diagnostic import UserError, error_about


class BrokenPackageError(UserError, ValueError):
    """A package.xml is invalid, so that rospack refuses to search packages. Its text begins with the path."""


def broken_package(path: str, reason: object) -> BrokenPackageError:
    """Return the error for an invalid package.xml, with the reason."""
    help_ = "correct this file, or take its folder out of ROS_PACKAGE_PATH"
    return BrokenPackageError(error_about(path, str(reason), rule="broken-package", help=help_))
