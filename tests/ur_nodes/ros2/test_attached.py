"""The profile with which nodes find each other soon."""

from __future__ import annotations

import pytest
from tests.ros2_session import Ros2Session

VARIABLES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
NODE = f"""
import os
from ur_nodes.ros2.attached import PROFILE, attach
with attach("node", lambda node: None, lambda: None, quiet=False):
    print(*(each for each in {VARIABLES} if os.environ.get(each) == str(PROFILE)))
"""


@pytest.mark.parametrize(("distro", "variable"), [("jazzy", VARIABLES[1]), ("kilted", VARIABLES[0])])
def test_node_has_fast_dds_read_its_profile(session: Ros2Session, distro: str, variable: str) -> None:
    session.environment["ROS_DISTRO"] = distro
    done = session.run("-c", NODE, within=60.0)
    assert (done.stdout, done.returncode) == (f"{variable}\n", 0)
    assert "XML" not in done.stderr  # which the parser names in its errors


@pytest.mark.parametrize("variable", VARIABLES)
def test_profile_of_the_user_stays(session: Ros2Session, variable: str) -> None:
    session.environment[variable] = "/nowhere.xml"
    assert session.run("-c", NODE, within=60.0).stdout == "\n"
