import pytest

from ur.robot.remote_run import NOT_READY, NOT_THERE, explain_failure
from ur.robot.ssh.shell import ShellResult


@pytest.mark.parametrize(
    ("done", "message", "help_"),
    [
        (ShellResult(NOT_THERE, "", ""), "bob: ubiquity_launches is not there", "ur robot setup bob"),
        (ShellResult(NOT_READY, "", ""), "bob: ubiquity_launches is not set up there", "ur robot setup bob"),
        (
            ShellResult(1, "", "x: No module named ur.run.remote.share\n"),
            "bob: ubiquity_launches there is older",
            "git pull",
        ),
        (ShellResult(1, "", "disk full\n"), "bob: its nodes cannot be started: disk full", "ur doctor bob"),
        (ShellResult(0, "", ""), "bob: its nodes cannot be started: exit code 0", "ur doctor bob"),
    ],
)
def test_robot_that_cannot_start_nodes_is_explained(done: ShellResult, message: str, help_: str) -> None:
    (found,) = explain_failure("ros@bob.local", done).diagnostics
    assert found.message.startswith(message)
    assert help_ in (found.help or "")
