"""Logs that cannot be written: a disk that is full (/dev/full takes nothing), and a pipe that nobody reads."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator

import pytest
from rosgraph import roslogging

from ur_nodes.ros1.repairs.logs import report_log_errors


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


def test_line_for_a_terminal_that_has_ended_is_dropped_and_the_node_goes_on() -> None:
    theirs, ours = os.pipe()
    os.close(theirs)  # what `ur` read, when it was killed
    pipe = os.fdopen(ours, "w", buffering=1)
    logger = logging.getLogger("rosout")
    handler = roslogging.RosStreamHandler(stdout=pipe, stderr=pipe)  # type: ignore[attr-defined]  # no stubs
    logger.addHandler(handler)
    try:
        with pytest.raises(BrokenPipeError):
            logger.error("as rospy has it")
        report_log_errors()
        logger.error("as the nodes of this project have it")
    finally:
        logger.removeHandler(handler)
        with pytest.raises(BrokenPipeError):
            pipe.close()
