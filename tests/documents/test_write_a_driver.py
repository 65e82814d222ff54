"""The driver of docs/how-to/write-a-driver.md, as it is written there, and its test."""

import os
import re
import subprocess
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT

PAGE = (ROOT / "docs" / "how-to" / "write-a-driver.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"^```\w+ (\S+)\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE))
(TEST,) = re.findall(r"^```sh\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


@pytest.mark.ros
def test_driver_of_the_page_passes_its_test(tmp_path: Path) -> None:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    environment = {**os.environ, "ROS_PACKAGE_PATH": f"{ROOT}/ubiquity_launches:/usr/share"}
    options = {"cwd": tmp_path, "env": environment, "capture_output": True, "text": True, "timeout": 120}
    done = subprocess.run(["bash", "-c", TEST], check=False, **options)  # type: ignore[call-overload]
    assert "3 passed" in done.stdout, done.stdout + done.stderr
