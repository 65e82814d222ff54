"""Reports of a run: the severity of each, on the console and to clients."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

from ur.run.output.reporter import RunReporter
from ur.run.supervisor.actions import ReportDeath, ReportMaster, ReportStop
from ur.run.supervisor.state import ExitStatus


class Kept:
    """Stands for the console, the monitor and the outputs, and keeps what they are given."""

    def __init__(self) -> None:
        self.printed: list[tuple[str, str]] = []
        self.notices: list[tuple[str, str]] = []

    def inform(self, text: str) -> None:
        self.printed.append(("inform", text))

    def warn(self, text: str) -> None:
        self.printed.append(("warn", text))

    def fail(self, text: str) -> None:
        self.printed.append(("fail", text))

    def publish_notice(self, severity: str, text: str) -> None:
        self.notices.append((severity, text))

    def find_last_lines(self, _name: str) -> tuple[str, ...]:
        return ("last words",)

    def find_path(self, _program: object) -> str:
        return "/log/a"


def make_reporter(report_event: Callable[[str], object] | None = None) -> tuple[RunReporter, Kept]:
    program = SimpleNamespace(unit=SimpleNamespace(name="/a", terminal=False), log_name="a")
    clients = SimpleNamespace(record_end=None, report_event=report_event)
    run = SimpleNamespace(
        folder="/log", middleware=None, programs=(program,), restart_share=None, list_joined=None, clients=clients
    )
    kept = cast("Any", Kept())
    return RunReporter(cast("Any", run), kept, kept, kept), kept


def test_death_is_an_error_whose_explanation_follows() -> None:
    reporter, kept = make_reporter()
    reporter.report(ReportDeath("/a", ExitStatus(code=1), restart_in=2.5))
    first, *rest = kept.printed
    assert first == ("fail", "/a died: exit code 1, starts again in 2.5 s")
    assert rest == [("warn", "  | last words"), ("warn", "  log: /log/a")]
    ((severity, text),) = kept.notices
    assert severity == "error"
    assert text.splitlines() == [first[1], "  | last words", "  log: /log/a"]
    assert reporter.last_lines[0] == f"error: {first[1]}"


def test_death_is_an_event_and_a_clean_end_is_none() -> None:
    events: list[str] = []
    reporter, _ = make_reporter(events.append)
    reporter.report(ReportDeath("/a", ExitStatus(code=0)))
    reporter.report(ReportDeath("/a", ExitStatus(code=1)))
    assert events == ["/a died: exit code 1"]


def test_clean_end_is_information() -> None:
    reporter, kept = make_reporter()
    reporter.report(ReportDeath("/a", ExitStatus(code=0)))
    assert kept.notices == [("info", "/a has finished")]


def test_only_a_failed_stop_and_a_lost_master_are_errors() -> None:
    reporter, kept = make_reporter()
    reporter.report(ReportStop("Ctrl-C", failed=False))
    reporter.report(ReportStop("/a died", failed=True))
    reporter.report(ReportMaster(lost=True))
    reporter.report(ReportMaster(lost=False))
    assert [severity for severity, _ in kept.notices] == ["info", "error", "error", "warning"]


def test_severity_is_not_read_from_the_text() -> None:
    reporter, kept = make_reporter()
    reporter.warn("error: as a node wrote it")
    assert kept.notices == [("warning", "error: as a node wrote it")]
