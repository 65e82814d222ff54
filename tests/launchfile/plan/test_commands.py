from functools import partial

from ur.launchfile.dump import dump_plan
from ur.launchfile.load import load_plan
from ur.launchfile.plan.commands import CommandRunner, run_command
from ur.launchfile.world.memory import MemoryWorld


def _dump(command: str, run: CommandRunner = run_command) -> dict[str, object]:
    world = MemoryWorld({"/a.launch": f'<launch><param name="p" command="{command}"/></launch>'})
    return dump_plan(load_plan(["/a.launch"], [], world), run=run)


def test_command_that_prints_without_end_is_stopped() -> None:
    assert "parameter /p has no value: yes: prints more than 1,000 bytes" in str(
        _dump("yes", partial(run_command, most=1000))["error"]
    )


def test_command_that_fails_is_named() -> None:
    assert "the command ended with code 1" in str(_dump("false")["error"])


def test_command_that_is_missing_is_named() -> None:
    assert "no_such_program: no such file" in str(_dump("no_such_program")["error"])
