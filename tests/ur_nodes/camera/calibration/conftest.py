"""These tests need OpenCV; where it is missing nothing here is collected."""

from importlib.util import find_spec
from pathlib import Path

_HERE = Path(__file__).parent
collect_ignore = [] if find_spec("cv2") else [path.name for path in _HERE.glob("test_*.py")]
