"""Tests change nothing for those that run after them."""

from pathlib import Path

from tests.test_parallel import run, write

OPTIONS = ("-p", "tests.conftest")


def test_environment_that_a_test_sets_ends_with_it(tmp_path: Path) -> None:
    write(
        tmp_path,
        test_a="""
        import os
        def test_sets():
            os.environ["ROS_VERSION"] = "0"
            del os.environ["PATH"]
        def test_reads():
            assert "PATH" in os.environ
            assert os.environ.get("ROS_VERSION") != "0"
        """,
    )
    code, output = run(tmp_path, *OPTIONS)
    assert code == 0, output


def test_run_that_leaves_a_temporary_folder_fails_by_its_name(tmp_path: Path) -> None:
    write(
        tmp_path,
        test_a="""
        import tempfile
        def test_leaves(): tempfile.mkdtemp(prefix="genpy_")
        def test_cleans_up():
            with tempfile.TemporaryDirectory(prefix="mine_"): pass
        """,
    )
    for more in ((), ("-n", "2")):
        code, output = run(tmp_path, *OPTIONS, *more)
        assert code == 1
        assert "2 passed" in output
        assert "left in the temporary folder" in output
        assert "genpy_" in output
        assert "mine_" not in output
