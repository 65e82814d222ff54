from pathlib import Path

import pytest

from ur.run.output.log_rotation import LogBounds, LogRotation, plan_cuts, plan_delay, read_bounds
from ur.source.diagnostic import UserError


def test_small_files_are_left_alone_and_a_large_one_keeps_half_of_the_bound() -> None:
    assert plan_cuts({"a": 100, "b": 101, "c": 0}, LogBounds(file=100, run=1000)) == {"b": 50}


def test_many_files_below_their_bound_are_cut_by_the_bound_of_the_run() -> None:
    sizes = {"small": 10, **dict.fromkeys("abcd", 90)}
    cuts = plan_cuts(sizes, LogBounds(file=100, run=210))
    assert cuts == dict.fromkeys("abcd", 25)  # (210 - 10) / 4 each, of which half is kept


def test_files_that_are_together_below_the_bound_of_the_run_are_not_cut() -> None:
    assert plan_cuts(dict.fromkeys("abcd", 50), LogBounds(file=100, run=200)) == {}
    assert plan_cuts({}, LogBounds(file=100, run=0)) == {}


def test_check_comes_sooner_the_faster_files_grow() -> None:
    assert plan_delay(0, 0, 5.0, 1000) == 5.0
    assert plan_delay(0, 1000, 1.0, 2000) == 1.0
    assert plan_delay(0, 1000, 1.0, 0) == 0.5


@pytest.mark.parametrize("text", ["many", "0", "-1", "nan", "1e12"])
def test_bound_that_is_no_size_is_refused(text: str) -> None:
    with pytest.raises(UserError, match="UR_LOG_MB"):
        read_bounds({"UR_LOG_MB": text})


def test_bound_of_a_file_sets_that_of_the_run() -> None:
    assert read_bounds({"UR_LOG_MB": "2.5"}) == LogBounds(2_500_000, 40_000_000)
    assert read_bounds({}) == LogBounds()


def test_only_own_files_are_cut_and_only_old_files_of_rosout_are_deleted(tmp_path: Path) -> None:
    for name in ("own-1-stdout.log", "own-1.log", "other-2-stdout.log", "rosout.log", "rosout.log.1", "rosout.log.2"):
        (tmp_path / name).write_bytes(bytes(100))
    cut: list[str] = []

    def drop(path: str, keep: int) -> int:
        cut.append(Path(path).name)
        return 100 - keep

    rotation = LogRotation(str(tmp_path), LogBounds(file=60, run=1000), drop)
    rotation.add("own-1")
    rotation.add("rosout-1")
    removed = rotation.check(1.0)
    assert sorted(cut) == ["own-1-stdout.log", "own-1.log"]
    assert set(removed.values()) == {70}
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"own-1-stdout.log", "own-1.log", "other-2-stdout.log", "rosout.log", "rosout.log.1"}
