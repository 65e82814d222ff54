"""How boot services are, in words."""

import pytest

from ur.robot.boot.units import SCRIPT, describe_status, parse_status
from ur.robot.ssh.shell import LocalShell
from ur.source.diagnostic import UserError

END = "\x1eend\n"
ANSWER = """\
\x1eId=ubiquity-{name}.service
ActiveState={active}
SubState={sub}
UnitFileState=enabled
NRestarts={restarts}
ActiveEnterTimestamp=Sat 2026-11-21 10:15:38 UTC
ExecMainStatus={code}
Pause={pause}
Said=first
Said=a=b
"""


def describe(active: str, sub: str, *, restarts: int = 0, code: int = 0, pause: str = "") -> list[str]:
    text = ANSWER.format(name="talk", active=active, sub=sub, restarts=restarts, code=code, pause=pause)
    (status,) = parse_status(text + END)
    return list(describe_status(status))


def test_service_that_runs_says_since_when_and_its_last_words() -> None:
    assert describe("active", "running") == ["talk: runs since Sat 2026-11-21 10:15:38 UTC", "  | first", "  | a=b"]


@pytest.mark.parametrize(
    ("active", "sub", "restarts", "pause", "said"),
    [
        ("active", "running", 3, "8", "started again 3 times"),
        ("activating", "start-pre", 0, "", "waits for the robot's own address"),
        ("activating", "start-pre", 4, "16", "pauses for 16 s before its next start, started again 4 times"),
        ("activating", "auto-restart", 1, "0", "ended with code 2; it is started again"),
        ("failed", "failed", 0, "", "does not run (failed)"),
        ("inactive", "dead", 0, "", "does not run (inactive)"),
    ],
)
def test_every_state_has_words(active: str, sub: str, restarts: int, pause: str, said: str) -> None:
    assert said in describe(active, sub, restarts=restarts, code=2, pause=pause)[0]


def test_service_that_is_not_enabled_is_told() -> None:
    (status,) = parse_status(
        ANSWER.format(name="x", active="active", sub="running", restarts=0, code=0, pause="").replace(
            "enabled", "disabled"
        )
        + END
    )
    assert "not enabled" in next(describe_status(status))


def test_several_services_are_read_one_by_one() -> None:
    text = "".join(
        ANSWER.format(name=n, active="active", sub="", restarts=0, code=0, pause="") for n in ("master", "a")
    )
    assert [each.name for each in parse_status(f"a greeting\n{text}{END}")] == ["master", "a"]


def test_script_of_a_computer_without_services_is_read_as_none() -> None:
    assert parse_status(LocalShell().run(SCRIPT.replace("ubiquity-", "ur-test-none-")).out) == []


@pytest.mark.parametrize("text", ["", "end\n", '{"files": {}}', f"{ANSWER}", "\x1eend\x1b]0;x\x07\n", f"{END}more"])
def test_answer_that_breaks_off_or_is_another_is_not_taken_for_no_service(text: str) -> None:
    with pytest.raises(UserError, match="cannot be read") as caught:
        parse_status(text)
    assert "\x1b" not in str(caught.value)
