"""Pictures of a bus on a pseudo-terminal, and in lines."""

import os
import threading
from dataclasses import replace

import pytest
from tests.ur_nodes.pictures.test_feed import JPEG, TOPIC
from tests.ur_nodes.teleop.screen import TypedTerminal

from ur_nodes.memory.bus import Bus
from ur_nodes.pictures.feed import FeedView, PictureFeed
from ur_nodes.ports.values import PackedPicture
from ur_nodes.teleop.camera.viewer import FeedLines, draw_view, show_pictures, write_lines

BROKEN = PackedPicture(0, "camera", "jpeg", JPEG.data[:-200])


def test_picture_fills_the_terminal_until_q_is_pressed() -> None:
    bus = Bus()
    feed = PictureFeed(bus.node("viewer"), "camera/image")
    bus.node("camera").publish(TOPIC, PackedPicture).send(JPEG)
    bus.run(0.1)
    with TypedTerminal(lambda terminal, ended: show_pictures(terminal, feed, ended, 0.01, rich=True)) as screen:
        screen.wait_for("64 x 48")
        assert "\x1b[38;2;2" in screen.text
        screen.type("q")
        screen.wait_end()
    assert screen.text.rstrip().endswith("\x1b[?1049l")


@pytest.mark.parametrize("key", ["\x03", "\x1b", "Q"])
def test_each_key_that_leaves_ends_the_view(key: str) -> None:
    feed = PictureFeed(Bus().node("viewer"), "camera/image")
    with TypedTerminal(lambda terminal, ended: show_pictures(terminal, feed, ended, 0.01, rich=True)) as screen:
        screen.wait_for("waiting for a publisher")
        screen.type(key)
        screen.wait_end()


def test_broken_picture_is_described_in_its_place() -> None:
    view = FeedView(TOPIC, PackedPicture(0, "camera", "jpeg", b"rubbish"), 1, (64, 48), 7)
    assert any(f"{TOPIC}: " in line for line in draw_view(view, 100, 10, rich=True)[:-1])


def test_lines_tell_how_pictures_arrive_every_two_seconds_and_reasons_when_they_change() -> None:
    lines = FeedLines()
    view = FeedView(TOPIC)
    waiting = f"{TOPIC}: waiting for a publisher"
    assert [lines.step(view, now) for now in (0.0, 0.1, 2.5)] == [waiting, "", ""]
    silent = replace(view, silence=3.0, reason="no node publishes it")
    reason = f"no picture on {TOPIC} for 3 s: no node publishes it"
    assert [lines.step(silent, now) for now in (3.0, 3.1, 5.5, 13.0)] == [reason, "", "", reason]
    coming = replace(view, picture=JPEG, size=(64, 48), rate=5.0)
    line = f"{TOPIC}   64 x 48   5.0 pictures a second   0 kB each"
    assert [lines.step(coming, now) for now in (14.0, 15.0, 16.0, 17.0)] == [line, "", line, ""]


def test_q_in_a_pipe_ends_the_lines_and_its_end_does_not(capsys: pytest.CaptureFixture[str]) -> None:
    feed = PictureFeed(Bus().node("viewer"), "camera/image")
    source, sink = os.pipe()
    os.write(sink, b"q")
    write_lines(feed, threading.Event(), source)
    assert capsys.readouterr().out == f"{TOPIC}: waiting for a publisher\n"
    os.close(sink)
    ended = threading.Event()
    thread = threading.Thread(target=write_lines, args=(feed, ended, source))
    thread.start()
    thread.join(0.3)
    assert thread.is_alive()
    ended.set()
    thread.join(60.0)
    os.close(source)
