"""Descriptions of recordings, as lines for people."""

import time
from collections.abc import Iterator

from ur.recordings.mcap_file import RecordingFile
from ur.source.printable import printable


def describe_recording(recording: RecordingFile) -> Iterator[str]:
    """Its time and length, its reasons and events, and its topics."""
    began = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(recording.start / 1e9))
    broken = "" if recording.complete else ", its end is missing"
    yield f"{recording.path}: {recording.seconds:.1f} s from {began}{broken}"
    for text in recording.metadata.get("reasons", {}).values():
        yield f"  because: {printable(text)}"
    for stamp, text in sorted(recording.metadata.get("events", {}).items()):
        yield f"  {_second(stamp, recording):7.1f} s  {printable(text)}"
    width = max((len(name) for name in recording.topics), default=0)
    for name, topic in sorted(recording.topics.items()):
        yield f"  {printable(name):<{width}}  {topic.count:6} messages  {printable(topic.type_name)}"


def _second(stamp: str, recording: RecordingFile) -> float:
    try:
        return float(stamp) - recording.start / 1e9
    except ValueError:
        return 0.0
