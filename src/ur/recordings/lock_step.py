"""Replays in lock step: their reports, and tests made of them."""

from __future__ import annotations

import pprint
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ur.recordings.mcap_channels import dialect_of, register_channel, start_writer
from ur.recordings.mcap_file import MAGIC, RecordingFile, RecordingTopic
from ur.source.printable import printable
from ur.source.replace import check_output, output_file

_TEST = b'"""'  # the beginning of a test


@dataclass(frozen=True, slots=True)
class Outcome:
    """The states of nodes by topic, each value once until it changes, and how goals ended: their state and text."""

    states: dict[str, list[str]] = field(default_factory=dict)
    endings: list[tuple[str, str]] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class StepReport:
    """The outcome as it was recorded and as it was replayed.

    `digest` is equal for replays in which the nodes have sent the same to the last bit: `sent` values. `used` are the
    topics of the recording that mattered, `log` has the warnings and errors of the nodes.
    """

    seconds: float
    sent: int
    digest: str
    recorded: Outcome
    replayed: Outcome
    used: list[str] = field(default_factory=list)
    log: list[str] = field(default_factory=list)

    @property
    def differences(self) -> list[str]:
        """Differences between the reports of nodes and the recorded ones, as lines for users."""
        before, now = self.recorded, self.replayed
        found = []
        if before.endings != now.endings:
            found.append(f"goals: {_describe_endings(now)}, recorded: {_describe_endings(before)}")
        for topic in sorted(before.states):
            values = now.states.get(topic, [])
            if values != before.states[topic]:
                found.append(f"{topic}: {' > '.join(values)}, recorded: {' > '.join(before.states[topic])}")
        return [printable(each) for each in found]


def describe_report(report: StepReport) -> Iterator[str]:
    """A report as lines for people."""
    yield f"{report.seconds:.1f} s, {report.sent} values sent, digest {report.digest[:16]}"
    for state, text in report.replayed.endings:
        yield printable(f"  goal {state}: {text}" if text else f"  goal {state}")
    for topic, values in sorted(report.replayed.states.items()):
        yield printable(f"  {topic}: {' > '.join(each or '(none)' for each in values)}")
    yield from (f"  differs: {each}" for each in report.differences)
    if not report.differences:
        yield "  as recorded"


def _describe_endings(outcome: Outcome) -> str:
    return "; ".join(f"{state}: {text}" for state, text in outcome.endings) or "none has ended"


def write_test(path: Path, recording: RecordingFile, arguments: Sequence[str], report: StepReport) -> Path:
    """Write a test of pytest, and beside it the topics of the recording that mattered. Returns the recording's path.

    `arguments` follow the file in the command line of `ur replay`. Raises UserError.
    """
    copy = check_test(path, recording.path)
    copy_topics(recording, copy, frozenset(report.used))
    reason = next(iter(recording.metadata.get("reasons", {}).values()), "what was recorded")
    with output_file(path, [recording.path], _TEST) as file:
        file.write(_test_text(copy.name, printable(reason), arguments, report).encode())
    return copy


def check_test(path: Path, recording: Path) -> Path:
    """Check the files that `write_test` writes; return the path of the recording. Raises UserError."""
    copy = path.with_suffix(".mcap")
    check_output(path, [recording], _TEST)
    check_output(copy, [recording], MAGIC)
    return copy


def copy_topics(recording: RecordingFile, path: Path, topics: frozenset[str]) -> None:
    """Copy some topics of a recording, and its metadata. Raises UserError."""
    channels: dict[RecordingTopic, int] = {}
    dialects = {dialect_of(each.type_name, each.schema) for each in recording.topics.values() if each.name in topics}
    profile = dialects.pop() if len(dialects) == 1 else ""
    with output_file(path, [recording.path], MAGIC) as file:
        writer = start_writer(file, profile, metadata=bool(recording.metadata))
        for message in recording.messages(topics=topics):
            topic = message.topic
            if topic not in channels:
                channels[topic] = register_channel(
                    writer, topic.name, topic.type_name, topic.schema, topic.sender, latched=topic.latched
                )
            writer.add_message(channels[topic], message.time, message.data, message.time)
        for name, values in recording.metadata.items():
            writer.add_metadata(name, dict(values))
        writer.finish()  # type: ignore[no-untyped-call]


def _test_text(name: str, reason: str, arguments: Sequence[str], report: StepReport) -> str:
    endings = pprint.pformat([list(each) for each in report.replayed.endings], width=100)
    states = pprint.pformat(report.replayed.states, width=100)
    command = pprint.pformat(["replay", "RECORDING", *arguments, "--json"], width=100).replace(
        "'RECORDING'", "str(RECORDING)"
    )
    title = reason.replace("\\", "/").replace('"', "'")
    return f'''"""{title}

Made by 'ur replay --as-test': the nodes run again against the recording, in lock step. They are to report what they
reported then; where they are to do better, change ENDINGS and STATES.
"""

import json
import subprocess
from pathlib import Path

RECORDING = Path(__file__).with_name("{name}")
COMMAND = {command}
ENDINGS = {endings}
STATES = {states}


def test_nodes_report_what_was_recorded():
    done = subprocess.run(["ur", *COMMAND], capture_output=True, text=True, check=False)
    assert done.stdout, done.stderr
    replayed = json.loads(done.stdout)["replayed"]
    assert replayed["endings"] == ENDINGS
    assert replayed["states"] == STATES
'''
