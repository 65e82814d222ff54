"""Commands of ssh in src end their options, so that no destination can be taken for one."""

from collections.abc import Mapping

from tests.form.facts import Facts

from ur.robot.doctor.observe import STRICT as DOCTOR
from ur.robot.setup.verify import STRICT as VERIFY

# Its lists hold what precedes the destination; tests/robot/ssh/test_destinations.py tests the whole command.
PARTS = "ur/robot/ssh/openssh.py"


def test_every_ssh_command_ends_its_options(modules: Mapping[str, Facts]) -> None:
    commands = [(path, command) for path, each in modules.items() for command in each.ssh_commands]
    assert len(commands) > 5
    assert [command for path, command in commands if path != PARTS and "'--'" not in command] == []
    assert DOCTOR.endswith(" --")
    assert VERIFY.endswith(" --")
