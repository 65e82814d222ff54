"""`ur replay --into`: nodes of a program against a recording, in lock step, and tests made of it."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from ur.recordings.lock_step import StepReport, check_test, describe_report, write_test
from ur.recordings.mcap_file import open_recording
from ur.request.arguments import Argument
from ur.request.environment import PACKAGE, apply_selection, current_selection
from ur.request.joining.lock_step import plan_lock_step
from ur.request.plan_files import make_world
from ur.source.diagnostic import UserError, error, error_about
from ur.source.foreign.json_values import BadJsonError, read_json, write_json

_MODULE = "ur_nodes.lock_step.run"
_MOST = 1 << 26  # characters of a report


def replay_in_lock_step(
    recording: Path,
    launch_file: str,
    given: Sequence[Argument],
    nodes: Sequence[str],
    as_test: str | None,
    words: Sequence[str],
    *,
    as_json: bool,
) -> int:
    """Replay, and print what the nodes reported. Returns 1 if it is not what they had reported.

    `words` are the program and its arguments, as they are typed.
    """
    test = None if as_test is None else Path(as_test)
    if test is not None:
        if test.suffix != ".py":
            message = "a test is a file test_NAME.py"
            raise UserError(error_about(test, message, rule="bad-name", help="--as-test test_corridor.py"))
        check_test(test, recording)
    selection = current_selection(os.environ)
    apply_selection(selection)
    plan = plan_lock_step(recording, launch_file, given, selection, make_world(), nodes)
    report = _run(plan)
    if test is not None:
        copy = write_test(test, open_recording(recording), [*words, *_into(nodes)], report)
        sys.stderr.write(f"{test}, {copy}: 'pytest {test}' runs it\n")
    text = write_json(report) if as_json else "\n".join(describe_report(report))
    sys.stdout.write(f"{text}\n")
    return int(bool(report.differences))


def _into(nodes: Sequence[str]) -> list[str]:
    return [word for node in nodes for word in ("--into", node)]


def _run(plan: str) -> StepReport:
    with tempfile.NamedTemporaryFile("w", suffix=".json", encoding="utf-8") as file:
        file.write(plan)
        file.flush()
        command = [str(PACKAGE / "lib" / "node"), _MODULE, file.name]
        done = subprocess.run(command, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True, check=False)
    if done.returncode == 2:
        raise SystemExit(2)  # the reason is printed
    try:
        return read_json(done.stdout, StepReport, _MOST)
    except BadJsonError:
        message = f"the replay in lock step ended with exit code {done.returncode}, expected its report"
        raise UserError(error(message, rule="replay-failed", help="'ur replay FILE PROGRAM' plays it on ROS")) from None
