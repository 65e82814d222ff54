"""These tests need OpenCV and gtsam; where they are missing one line says so and nothing here is collected."""

from importlib.util import find_spec
from pathlib import Path

import pytest

MISSING = [name for name in ("cv2", "gtsam") if find_spec(name) is None]
HERE = Path(__file__).parent
collect_ignore = [str(path.relative_to(HERE)) for path in HERE.rglob("test_*.py")] if MISSING else []
if MISSING:
    collect_ignore.remove("test_requirements.py")


@pytest.fixture
def missing() -> list[str]:
    return MISSING
