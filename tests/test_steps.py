"""tests/steps.bash: steps of .ci/run and tests/nightly, and the table that they end with."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def run_steps(script: str, *, only: str = "", keep: tuple[int, ...] = ()) -> subprocess.CompletedProcess[str]:
    text = f"set -u\nonly={only}\n. {ROOT}/tests/steps.bash\n{script}\n"
    return subprocess.run(["bash", "-c", text], capture_output=True, text=True, timeout=60, pass_fds=keep)


def read_table(printed: str) -> dict[str, list[str]]:
    """The columns of each step's row, by its name."""
    _, _, table = printed.rpartition("step  ")
    rows = [line.split(maxsplit=4) for line in table.split("\n\n")[0].splitlines()[1:]]
    return {name: columns for name, *columns in rows}


def test_table_has_result_and_tests_of_each_step_and_a_failure_stops_no_other() -> None:
    done = run_steps("""
        beside back bash -c 'echo 7 passed in 2.0s; exit 3'
        step bad bash -c 'echo "1 failed, 2 passed in 0.1s" >&2; false'
        step missing no-such-command
        step good true
        finish back
        report
    """)
    assert done.returncode == 1
    rows = read_table(done.stdout)
    assert {name: columns[2:] for name, columns in rows.items()} == {
        "bad": ["failed", "1 failed, 2 passed"],
        "missing": ["failed"],
        "good": ["passed"],
        "back": ["failed", "7 passed"],
    }
    assert done.stdout.endswith("steps: 1 passed, 3 failed\n")
    assert "no-such-command: command not found" in done.stdout
    assert "7 passed in 2.0s" in done.stdout


def test_processor_time_of_a_step_has_its_children_and_not_what_runs_beside_it(tmp_path: Path) -> None:
    fifo = tmp_path / "computed"
    os.mkfifo(fifo)
    compute = f"{sys.executable} -c 'import time\nwhile time.process_time() < 0.3: pass'"
    done = run_steps(f"""
        beside back bash -c "{compute}; echo >{fifo}"
        step front cat {fifo}
        finish back
        report
    """)
    assert done.returncode == 0, done.stdout + done.stderr
    seconds = {name: float(columns[1]) for name, columns in read_table(done.stdout).items()}
    assert seconds["back"] >= 0.3
    assert seconds["front"] < 0.3


def test_only_the_named_steps_run_and_an_unknown_one_fails() -> None:
    script = "step one true\nbeside two true\nstep three true\nfinish two\nreport"
    done = run_steps(script, only="two,three")
    assert (done.returncode, list(read_table(done.stdout))) == (0, ["three", "two"])
    done = run_steps(script, only="one,four")
    assert (done.returncode, list(read_table(done.stdout))) == (1, ["one"])
    assert done.stderr == "error: no step 'four', expected of: one three two\n"


def test_step_that_runs_beside_others_ends_with_the_script(tmp_path: Path) -> None:
    fifo = tmp_path / "started"
    os.mkfifo(fifo)
    reader, writer = os.pipe()  # ends with the last process of the step
    script = f"""
        beside back bash -c 'sleep 1000 & echo >{fifo}; wait'
        read -r <{fifo}
        echo "$work"
    """
    done = run_steps(script, keep=(writer,))
    os.close(writer)
    with os.fdopen(reader) as end:
        assert end.read() == ""
    assert not Path(done.stdout.splitlines()[-1]).exists()
