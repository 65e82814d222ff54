import pytest


def test_mapping_is_tested_here(missing: list[str]) -> None:
    if missing:
        pytest.skip(f"{' and '.join(missing)} not installed: pip install -r requirements/vision.lock to test mapping")
