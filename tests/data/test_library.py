"""The launch library, linted: `ur check ubiquity_launches` finds nothing."""

from __future__ import annotations

import os
from pathlib import Path

from ur.check.session import check_paths
from ur.check.worlds import make_world
from ur.cli.main import main
from ur.source.render import render_human

LIBRARY = str(Path(__file__).parents[2] / "ubiquity_launches")


def test_library_is_clean() -> None:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("ROS_")}
    report = check_paths([LIBRARY], make_world([LIBRARY], environment))
    # What Debian packages belongs to the computer: a viewer or a robot need not have all of it.
    findings = [found for found in report.findings if found.rule != "package-not-installed"]
    assert render_human(findings) == ""
    assert report.files >= 20


def test_library_is_laid_out_as_ur_format_does() -> None:
    assert main(["format", "--check", LIBRARY]) == 0


def test_library_names_the_packages_it_uses_and_installs_what_it_needs() -> None:
    assert main(["package", LIBRARY]) == 0
