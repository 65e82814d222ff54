from __future__ import annotations

import pytest

from ur.run.actions import TellDeath
from ur.run.model import ExitStatus
from ur.run.report import describe_death, describe_status


@pytest.mark.parametrize(
    ("status", "text"),
    [
        (ExitStatus(code=3), "exit code 3"),
        (ExitStatus(signal=11), "signal SIGSEGV (segmentation fault)"),
        (ExitStatus(signal=40), "signal 40"),
        (ExitStatus(), "not started"),
    ],
)
def test_status_is_described_by_name(status: ExitStatus, text: str) -> None:
    assert describe_status(status) == text


def test_death_shows_last_lines_and_log() -> None:
    death = TellDeath("/a", ExitStatus(code=1), restart_in=2.5)
    assert describe_death(death, ["x"], "/log/a") == [
        "error: /a died: exit code 1, starts again in 2.5 s",
        "  | x",
        "  log: /log/a",
    ]


def test_death_without_a_word_says_so() -> None:
    death = TellDeath("/a", ExitStatus(signal=9), ends_run=True)
    assert describe_death(death, [], "/log/a") == [
        "error: /a died: signal SIGKILL (killed), which ends the run",
        "  log: /log/a (it printed nothing)",
        "  try: somebody killed it; when it was the kernel, for want of memory: journalctl -k | grep -i oom",
    ]


def test_crash_and_storm_say_what_to_try() -> None:
    assert "gdb" in describe_death(TellDeath("/a", ExitStatus(signal=11)), [], "/log/a")[-1]
    told = describe_death(TellDeath("/a", ExitStatus(code=2), deaths=3), ["bad speed"], "/log/a")
    assert told[0] == "error: /a died: exit code 2, 3 times in a row soon after its start: it is not started again"
    assert told[-1] == "  try: exit code 2 is about what it was given: correct that, then 'ur restart /a'"


def test_clean_end_is_no_error() -> None:
    assert describe_death(TellDeath("/a", ExitStatus(code=0)), ["x"], "/log/a") == ["/a has finished"]
