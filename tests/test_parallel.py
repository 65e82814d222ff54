"""Tests in forks of one process: their reports, what they share, and what follows when one of them ends its process."""

import os
import re
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def write(folder: Path, **files: str) -> None:
    marks = "\n  ".join(("ros", "slow", "robot", "hosts", "seconds"))
    (folder / "pytest.ini").write_text(f"[pytest]\naddopts = -q -p tests.parallel\nmarkers = {marks}\n")
    for name, text in files.items():
        (folder / f"{name}.py").write_text(textwrap.dedent(text))


def start(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "pytest", "--rootdir", str(folder), "-p", "no:cacheprovider", *arguments]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    environment |= {"PYTEST_ADDOPTS": "", "UR_COVERAGE": ""}
    return subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


def run(folder: Path, *arguments: str) -> tuple[int, str]:
    with start(folder, *arguments) as process:
        try:
            output, _ = process.communicate(timeout=60)
        finally:
            process.kill()
    return process.returncode, output


def test_results_output_and_warnings_are_those_of_one_process(tmp_path: Path) -> None:
    write(
        tmp_path,
        test_a="""
            import warnings, pytest
            def test_passes(): pass
            def test_fails(): print("printed by a"); assert 1 == 2
            def test_is_skipped(): pytest.skip("not today")
            """,
        test_b="""
            import warnings, pytest
            def test_warns(): warnings.warn("an old call", DeprecationWarning)
            @pytest.fixture
            def broken(): raise OSError("no disk")
            def test_needs(broken): pass
            """,
    )
    code, output = run(tmp_path, "-n", "2", "-rs")
    assert code == 1, output
    assert "1 failed, 2 passed, 1 skipped, 1 warning, 1 error" in output
    for text in ("printed by a", "assert 1 == 2", "not today", "DeprecationWarning: an old call", "OSError: no disk"):
        assert text in output
    assert re.sub(r"in [0-9.]+s", "", output.splitlines()[-1]) == re.sub(
        r"in [0-9.]+s", "", run(tmp_path, "-rs")[1].splitlines()[-1]
    )


def test_modules_are_imported_once_and_a_file_stays_in_one_process(tmp_path: Path) -> None:
    module = """
        import os, pytest
        open("imported", "a").write("x")
        @pytest.fixture(scope="module")
        def shared():
            yield os.getpid()
            open("ended", "a").write("x")
        @pytest.mark.parametrize("number", range(5))
        def test_number(number, shared, tmp_path):
            assert shared == os.getpid() != {parent}
        """
    write(tmp_path, **{f"test_{name}": module.format(parent="os.getppid()") for name in "abcd"})
    code, output = run(tmp_path, "-n", "3")
    assert code == 0, output
    assert "20 passed" in output
    assert len((tmp_path / "imported").read_text()) == 4
    assert len((tmp_path / "ended").read_text()) == 4


@pytest.mark.parametrize("mark", ["slow", "hosts"])
def test_large_tests_of_a_file_run_beside_each_other(tmp_path: Path, mark: str) -> None:
    write(
        tmp_path,
        test_a="""
            import os, pathlib, pytest, time
            @pytest.mark.MARK
            @pytest.mark.parametrize("mine, other", ["ab", "ba"])
            def test_meets_the_other(mine, other):
                pathlib.Path(mine).touch()
                end = time.monotonic() + 20
                while not pathlib.Path(other).exists():
                    assert time.monotonic() < end
            """.replace("MARK", mark),
    )
    code, output = run(tmp_path, "-n", "2")
    assert code == 0, output


def test_at_most_a_third_of_the_workers_run_robots_and_one_more_once_only_robots_are_left(tmp_path: Path) -> None:
    robot = """
        import pathlib, pytest, secrets, time
        here = pathlib.Path()
        def count(name):
            return len(list(here.glob(f"{name}_*")))
        @pytest.mark.robot
        @pytest.mark.parametrize("number", range(3))
        def test_runs(number):
            mine = here / f"running_{secrets.token_hex(4)}"
            mine.touch()
            (here / f"begun_{secrets.token_hex(4)}").touch()
            running = count("running")
            assert running <= (2 if count("light") else 3)
            end = time.monotonic() + 40
            while not (here / "met").exists() and (count("begun") >= 12 if count("light") else count("running") < 3):
                assert time.monotonic() < end
            if not count("light"):
                (here / "met").touch()
            mine.unlink()
        """
    light = """
        import pathlib, time
        def test_light():
            mine = pathlib.Path("light_{name}")
            mine.touch()
            end = time.monotonic() + 40
            while len(list(pathlib.Path().glob("begun_*"))) < 6:
                assert time.monotonic() < end
            mine.unlink()
        """
    write(tmp_path, **{f"test_robot_{name}": robot for name in "abcdefgh"})
    write(tmp_path, **{f"test_light_{name}": light.format(name=name) for name in "abcde"})
    code, output = run(tmp_path, "-n", "5")
    assert code == 0, output
    assert "29 passed" in output


def test_one_worker_runs_robots_too(tmp_path: Path) -> None:
    robot = "import pytest\n@pytest.mark.robot\ndef test_runs(): pass\n"
    write(tmp_path, test_robot_a=robot, test_robot_b=robot, test_light="def test_light(): pass\n")
    code, output = run(tmp_path, "-n", "1")
    assert code == 0, output
    assert "3 passed" in output


def test_what_waits_and_what_takes_longest_is_handed_out_first(tmp_path: Path) -> None:
    one = """
        import pytest
        @pytest.mark.seconds({seconds})
        {more}
        def test_one():
            open("order", "a").write("{name}")
        def test_quick():
            pass
        """
    for name, seconds, more in (("a", 1, ""), ("b", 3, ""), ("c", 2, "@pytest.mark.ros"), ("d", 9, "@pytest.mark.ros")):
        write(tmp_path, **{f"test_{name}": one.format(name=name, seconds=seconds, more=more)})
    write(tmp_path, test_e="def test_quick(): open('order', 'a').write('e')\n")
    code, output = run(tmp_path, "-n", "1")
    assert code == 0, output
    assert (tmp_path / "order").read_text() == "dcbae"


def test_robot_that_ends_its_process_is_replaced(tmp_path: Path) -> None:
    write(
        tmp_path,
        test_a="""
            import os, pytest
            pytestmark = pytest.mark.robot
            @pytest.mark.parametrize("number", range(4))
            def test_ends(number):
                if number == 1:
                    os._exit(3)
            """,
        test_b="import pytest\npytestmark = pytest.mark.robot\ndef test_other(): pass\n",
    )
    code, output = run(tmp_path, "-n", "3")
    assert code == 1, output
    assert "1 failed, 4 passed" in output


def test_slow_tests_that_share_a_fixture_run_in_one_process(tmp_path: Path) -> None:
    write(
        tmp_path,
        test_a="""
            import os, pytest
            @pytest.fixture(scope="module")
            def robot():
                return os.getpid()
            @pytest.fixture
            def page(robot):
                return robot
            @pytest.mark.slow
            @pytest.mark.parametrize("number", range(8))
            def test_uses_the_robot(page, number):
                open("pids", "a").write(f"{page}\\n")
            """,
    )
    code, output = run(tmp_path, "-n", "2")
    assert code == 0, output
    pids = (tmp_path / "pids").read_text().split()
    assert len(pids) == 8
    assert len(set(pids)) == 1


def test_files_of_a_folder_that_share_a_fixture_run_in_one_process(tmp_path: Path) -> None:
    rules = tmp_path / "rules"
    rules.mkdir()
    fixture = """
        import pytest
        @pytest.fixture(scope="package")
        def facts():
            open("made", "a").write("x")
        """
    use = "def test_one(facts): pass\ndef test_other(): pass\n"
    write(tmp_path, test_x="def test_x(): pass\n", test_y="def test_y(): pass\n")
    write(rules, conftest=fixture, **{f"test_{name}": use for name in "abcd"})
    (rules / "pytest.ini").unlink()
    code, output = run(tmp_path, "-n", "3")
    assert code == 0, output
    assert "10 passed" in output
    assert (tmp_path / "made").read_text() == "x"


def test_test_that_ends_its_process_has_failed_and_the_others_run(tmp_path: Path) -> None:
    write(
        tmp_path,
        test_a="""
            import os, signal
            def test_first(): pass
            def test_ends(): os.kill(os.getpid(), signal.SIGKILL)
            def test_last(): pass
            """,
        test_b="def test_other(): pass\n",
    )
    code, output = run(tmp_path, "-n", "2")
    assert code == 1, output
    assert "1 failed, 3 passed" in output
    assert "the process of this test ended with exit code -9" in output
    assert "FAILED test_a.py::test_ends" in output


def test_first_failure_ends_the_run_where_that_is_asked_for(tmp_path: Path) -> None:
    write(
        tmp_path,
        test_a="""
            import pathlib, pytest, threading
            @pytest.fixture
            def waiting():
                pathlib.Path("waits").touch()
                yield
                pathlib.Path("taken_down").touch()
            def test_waits(waiting): threading.Event().wait()
            """,
        test_b="""
            import pathlib
            def test_fails():
                while not pathlib.Path("waits").exists(): pass
                raise AssertionError("as it should")
            """,
    )
    code, output = run(tmp_path, "-n", "2", "-x")
    assert code == 1, output
    assert "stopping after 1 failures" in output
    assert (tmp_path / "taken_down").exists()


def test_ctrl_c_takes_down_what_tests_have_set_up(tmp_path: Path) -> None:
    write(
        tmp_path,
        test_a="""
            import os, pathlib, pytest, threading
            @pytest.fixture
            def waiting():
                yield
                pathlib.Path("taken_down").touch()
            def test_waits(waiting):
                with open("waits", "w"): pass
                threading.Event().wait()
            """,
    )
    os.mkfifo(tmp_path / "waits")
    process = start(tmp_path, "-n", "1")
    with (tmp_path / "waits").open():
        process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 2, output
    assert "KeyboardInterrupt" in output
    assert (tmp_path / "taken_down").exists()
