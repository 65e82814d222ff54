from pathlib import Path

from ur.robot.setup.facts import ABSENT, ComputerFacts
from ur.robot.setup.keys import HOST_KEY
from ur.robot.setup.packages import WantedPackages
from ur.robot.setup.viewer_states import wanted_here
from ur.run.debugger.choice import PACKAGES


def test_viewer_gets_every_debugger_that_launch_knows() -> None:
    facts = ComputerFacts("you", "/home/you", "viewer", "Debian 12", "boot", frozenset(), files={HOST_KEY: ABSENT})
    (wanted,) = (item for item in wanted_here(facts, Path("/repository")) if isinstance(item, WantedPackages))
    assert {name for entry in wanted.names for name in entry.split("|")} >= set(PACKAGES.values())
