"""Reports of replays in lock step, and the tests that are made of them."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

from tests.recordings.test_mcap_file import write_recording

from ur.recordings.lock_step import Outcome, StepReport, describe_report, write_test
from ur.recordings.mcap_file import open_recording
from ur.source.foreign.json_values import write_json

OUTCOME = Outcome({"/move_base/hold": ["", "held"]}, [("aborted", 'no "path"')])
REPORT = StepReport(12.5, 300, "abc", OUTCOME, OUTCOME, ["/words"])


def test_report_prints_what_was_reported_and_what_differs() -> None:
    lines = list(describe_report(REPORT))
    assert lines[0].startswith("12.5 s, 300 values sent")
    assert lines[1:] == ['  goal aborted: no "path"', "  /move_base/hold: (none) > held", "  as recorded"]
    other = replace(REPORT, replayed=Outcome({"/move_base/hold": [""]}, []))
    assert other.differences == [
        'goals: none has ended, recorded: aborted: no "path"',
        "/move_base/hold: , recorded:  > held",
    ]


def test_made_test_passes_until_the_nodes_report_something_else(tmp_path: Path) -> None:
    recording = open_recording(write_recording(tmp_path / "one.mcap"))
    test = tmp_path / "test_corridor.py"
    copy = write_test(test, recording, ["keyboard_navigate", "--into", "move_base"], REPORT)
    assert set(open_recording(copy).topics) == {"/words"}
    ur = tmp_path / "bin/ur"
    ur.parent.mkdir()
    for report, code in ((REPORT, 0), (replace(REPORT, replayed=Outcome()), 1)):
        ur.write_text(f"#!/bin/sh\n[ $2 = {copy} ] && cat <<'END'\n{write_json(report)}\nEND\n")
        ur.chmod(0o755)
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(test)],
            env={"PATH": f"{ur.parent}:/usr/bin:/bin"},
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == code, done.stdout
