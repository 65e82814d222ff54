import os
from pathlib import Path

import pytest
from bench.long_parts.process_samples import ProcessSample, Sample, describe_growth, fit_slope, has_risen, take_sample


def samples(memory: list[float], files: list[int], logs: float = 1.0) -> list[Sample]:
    return [
        Sample(15.0 * index, {"node": ProcessSample(each, count, 3, 0.1 * index)}, logs)
        for index, (each, count) in enumerate(zip(memory, files, strict=True))
    ]


def test_slope_is_that_of_the_line_through_the_points() -> None:
    assert fit_slope([0.0, 1.0, 2.0], [1.0, 3.0, 5.0]) == pytest.approx(2.0)
    assert fit_slope([1.0, 1.0], [1.0, 2.0]) == 0.0


def test_counts_that_only_vary_have_not_risen() -> None:
    assert not has_risen([5, 7, 5, 7])
    assert has_risen([5, 5, 6, 6])
    assert not has_risen([5, 5, 6])


def test_growth_before_the_run_is_warm_does_not_count() -> None:
    _, growing = describe_growth(samples([10.0, 50.0, 50.1, 50.0, 50.1], [1, 9, 9, 9, 9]), warm=15.0)
    assert growing == []


def test_each_kind_of_growth_is_named() -> None:
    lines, growing = describe_growth(samples([50.0, 52.0, 54.0, 56.0, 58.0], [4, 5, 6, 7, 8], 1000.0), warm=0.0)
    assert growing == ["memory of node", "open files of node", "log files, above their bound"]
    assert "8.00" in lines[1]  # MB an hour
    assert lines[1].split()[3] == "400"  # kB written


def test_sample_names_the_process_and_counts_its_log_files(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_bytes(bytes(3_000_000))
    sample = take_sample(os.getpid(), tmp_path, 1.0)
    assert sample.logs == 3.0
    assert sample.processes["ur launch"].memory > 1.0
    assert sample.processes["ur launch"].files > 2
