"""`ur launch --debug`: the plan of nodes under debuggers; nothing is started."""

import shutil
from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.system import SystemWorld
from ur.request.debugging import debug_nodes, has_terminal
from ur.source.diagnostic import UserError

LAUNCH = """<launch>
  <node pkg="talk" type="talk" name="talk" respawn="true" launch-prefix="nice"/>
  <node pkg="talk" type="listen" name="listen"/>
</launch>
"""


@pytest.fixture
def world(tmp_path: Path) -> SystemWorld:
    package = tmp_path / "talk"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>talk</name></package>")
    program = package / "talk"
    program.write_text("#!/usr/bin/env python3\n")
    program.chmod(0o755)
    shutil.copy("/bin/sleep", package / "listen")
    (package / "talk.launch").write_text(LAUNCH)
    return SystemWorld({"ROS_PACKAGE_PATH": str(tmp_path), "PATH": "/usr/bin:/bin", "HOME": str(tmp_path)})


@pytest.fixture
def plan(world: SystemWorld, tmp_path: Path) -> Plan:
    return load_plan([str(tmp_path / "talk/talk.launch")], [], world)


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ("nobody", "nobody"),
        ("talk=gbd", "no such debugger, expected one of"),
        ("listen=pudb", "listen"),
    ],
)
def test_unknown_node_or_unsuitable_debugger_is_refused_by_name(
    world: SystemWorld, plan: Plan, request_: str, message: str
) -> None:
    with pytest.raises(UserError) as refused:
        debug_nodes(plan, [request_], world, terminal=False)
    assert message in str(refused.value.diagnostics[0].message)


@pytest.mark.skipif(not shutil.which("gdb"), reason="gdb is not installed")
def test_node_under_a_debugger_is_not_started_again_and_the_others_stay(world: SystemWorld, plan: Plan) -> None:
    changed, _ = debug_nodes(plan, ["listen=gdb"], world, terminal=not has_terminal())
    talk, listen = changed.nodes
    assert talk == plan.nodes[0]
    assert "gdb" in (listen.launch_prefix or "")
    assert not listen.respawn
