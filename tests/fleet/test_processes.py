"""Processes that run side by side: their output is kept apart, and nothing of them outlives the command."""

import os
import select
import subprocess
import sys
from pathlib import Path

import pytest

from ur.fleet.jobs import Fleet, Job
from ur.fleet.processes import Processes

ASKING = """\
import sys
from ur.fleet.processes import answer_confirmed
print("plan", flush=True)
print("agreed" if answer_confirmed(0) else "refused", flush=True)
"""


def show_nothing(_fleet: Fleet, _now: float) -> None:
    pass


def sh(name: str, script: str, stdin: str = "") -> Job:
    return Job(name, ("sh", "-c", script), stdin)


def test_outputs_are_apart_and_codes_are_kept(tmp_path: Path) -> None:
    jobs = [
        sh("bob", "read -r a; echo got $a; echo why >&2", "word\n"),
        sh("eve", "seq 3; exit 3"),
        sh("k/t", "kill -9 $$"),
    ]
    with Processes(jobs, tmp_path / "logs", "some verb") as processes:
        fleet = processes.run(show_nothing)
        said = [output.log.read_all() for output in processes.outputs]
    assert [each.code for each in fleet] == [0, 3, 137]
    assert said == ["got word\nwhy\n", "1\n2\n3\n", ""]
    assert fleet[1].line == "1"  # a short output of one that failed begins with the error
    assert (tmp_path / "logs/some_verb-k_t.log").stat().st_mode & 0o777 == 0o600


def test_no_more_run_at_once_than_the_limit(tmp_path: Path) -> None:
    most: list[int] = []

    def count(fleet: Fleet, _now: float) -> None:
        most.append(sum(each.phase == "running" for each in fleet))

    with Processes([sh(f"r{number}", "true") for number in range(6)], tmp_path, "verb", limit=2) as processes:
        fleet = processes.run(count)
    assert max(most) == 2
    assert [each.code for each in fleet] == [0] * 6


@pytest.mark.parametrize(("agreed", "said"), [(True, "agreed"), (False, "refused")])
def test_all_plans_are_there_before_the_question_and_all_get_its_answer(
    tmp_path: Path, agreed: bool, said: str
) -> None:
    asked: list[list[str]] = []
    asking = [Job(name, (sys.executable, "-c", ASKING), asks=True) for name in ("bob", "eve")]
    with Processes([*asking, sh("kit", "exit 2")], tmp_path, "verb") as processes:

        def confirm(fleet: Fleet, outputs: object) -> bool:
            assert outputs is processes.outputs
            asked.append(
                [f"{each.phase} {output.log.read_all()}" for each, output in zip(fleet, processes.outputs, strict=True)]
            )
            return agreed

        fleet = processes.run(show_nothing, confirm)
    assert asked == [["asking plan\n", "asking plan\n", "done "]]
    assert [each.line for each in fleet[:2]] == [said, said]
    assert [output.log.path.read_text() for output in processes.outputs[:2]] == [f"plan\n{said}\n"] * 2


def test_interruption_ends_all_and_says_so(tmp_path: Path) -> None:
    script = "trap 'echo ended; exit 130' INT; echo begun; while :; do read -r line <$0; done"
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    jobs = [Job(name, ("bash", "-c", script, str(fifo))) for name in ("bob", "eve")]

    def interrupt(fleet: Fleet, _now: float) -> None:
        if all(each.line == "begun" for each in fleet):
            raise KeyboardInterrupt

    with Processes(jobs, tmp_path, "verb") as processes, pytest.raises(KeyboardInterrupt):
        processes.run(interrupt)
    assert [each.code for each in processes.fleet] == [130, 130]
    assert [output.log.path.read_text() for output in processes.outputs] == ["begun\nended\n"] * 2


def test_killed_command_takes_its_processes_with_it(tmp_path: Path) -> None:
    program = (
        "import sys; from pathlib import Path; from ur.fleet.jobs import Job; "
        "from ur.fleet.processes import Processes\n"
        "def show(fleet, now):\n    print(fleet[0].line, flush=True)\n"
        "with Processes([Job('bob', ('sh', '-c', 'echo $$; exec sleep 600'))], Path(sys.argv[1]), 'v') as all:\n"
        "    all.run(show)\n"
    )
    with subprocess.Popen([sys.executable, "-c", program, str(tmp_path)], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout
        number = next(int(line) for line in parent.stdout if line.strip())
        handle = os.pidfd_open(number)
        parent.kill()
    with os.fdopen(handle):
        assert select.select([handle], [], [], 30)[0], "the process has not ended"
