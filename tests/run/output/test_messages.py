import pytest

from ur.run.output.messages import LossLines, describe_death, describe_link, describe_status
from ur.run.supervisor.actions import ReportDeath
from ur.run.supervisor.state import ExitStatus


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


def test_link_is_described_in_a_line() -> None:
    assert describe_link("bob", 1.23, lost=True) == "no word from bob for 1.2 s"
    assert describe_link("bob", 12.3, lost=False) == "bob answers again after 12.3 s"


def test_news_of_a_lost_link_become_lines_ever_more_rarely() -> None:
    lines = LossLines()
    told = [seconds for seconds in (1.0, 1.5, 2.0, 2.5, 3.5, 4.0, 7.5, 8.0) if lines.is_due(seconds, lost=True)]
    assert told == [1.0, 2.0, 4.0, 8.0]
    assert lines.is_due(8.5, lost=False)
    assert lines.is_due(1.0, lost=True)  # of the next loss


def test_death_shows_last_lines_and_log() -> None:
    death = ReportDeath("/a", ExitStatus(code=1), restart_in=2.5)
    assert describe_death(death, ["x"], "/log/a") == [
        "/a died: exit code 1, starts again in 2.5 s",
        "  | x",
        "  log: /log/a",
    ]


def test_death_without_a_word_says_so() -> None:
    death = ReportDeath("/a", ExitStatus(signal=9), ends_run=True)
    assert describe_death(death, [], "/log/a") == [
        "/a died: signal SIGKILL (killed), which ends the run",
        "  log: /log/a (it printed nothing)",
        "  try: it was killed; if the kernel did, for want of memory: journalctl -k | grep -i oom",
    ]


def test_crash_and_storm_say_what_to_try() -> None:
    assert "gdb" in describe_death(ReportDeath("/a", ExitStatus(signal=11)), [], "/log/a")[-1]
    told = describe_death(ReportDeath("/a", ExitStatus(code=2), deaths=3), ["bad speed"], "/log/a")
    assert told[0] == "/a died: exit code 2, 3 times in a row soon after its start: it is not started again"
    assert told[-1] == "  try: exit code 2 is about what it was given: correct that, then 'ur restart /a'"


def test_clean_end_is_no_error() -> None:
    assert describe_death(ReportDeath("/a", ExitStatus(code=0)), ["x"], "/log/a") == ["/a has finished"]
