import os
import sys

import pytest
from bench.scale_parts.rows import fit_exponent, measure_command


@pytest.mark.parametrize("exponent", [0.5, 1.0, 2.0])
def test_exponent_of_a_power_law_is_found(exponent: float) -> None:
    fitted = fit_exponent((size, 3.0 * size**exponent) for size in (10, 30, 100, 300))
    assert fitted == pytest.approx(exponent)


def test_one_size_has_no_exponent() -> None:
    assert fit_exponent([(10, 1.0), (10, 2.0)]) is None
    assert fit_exponent([(10, 1.0), (20, 0.0)]) is None


def test_cost_of_a_command_covers_its_children() -> None:
    child = "kept = b'x' * 60_000_000; sum(range(3_000_000)); raise SystemExit(3)"
    code = f"import subprocess, sys; sys.exit(subprocess.call([sys.executable, '-c', {child!r}]))"
    usage = measure_command([sys.executable, "-c", code], os.environ)
    assert usage.code == 3
    assert usage.memory > 60
    assert usage.processor > 0.01
