"""Log files on a disk that is full: /dev/full takes nothing."""

from __future__ import annotations

import logging
from collections.abc import Iterator

import pytest

from ur_nodes.ros1.repairs.log_errors import report_log_errors


@pytest.fixture
def full_disk() -> Iterator[logging.Logger]:
    logger = logging.getLogger("rosout")
    handler = logging.FileHandler("/dev/full")
    logger.addHandler(handler)
    yield logger
    logger.removeHandler(handler)
    with pytest.raises(OSError, match="No space left"):
        handler.close()


def test_full_disk_is_reported_once_and_without_a_traceback(
    full_disk: logging.Logger, capsys: pytest.CaptureFixture[str]
) -> None:
    report_log_errors()
    for number in range(3):
        full_disk.error("line %d", number)
    (said,) = capsys.readouterr().err.splitlines()
    assert '"/dev/full"' in said
    assert "No space left on device" in said
