"""Views of a rendered board that a camera on a bus shows, on a pseudo-terminal and in lines."""

import os
import threading

import pytest
from tests.ur_nodes.camera.calibration.rendered_board import Studio, list_poses, project_views
from tests.ur_nodes.camera.fake_device import encode
from tests.ur_nodes.teleop.screen import TypedTerminal

from ur_nodes.camera.calibration.board import Board
from ur_nodes.camera.calibration.screen import Views, show_session, write_session
from ur_nodes.camera.calibration.session import CalibrationSession
from ur_nodes.memory.bus import Bus
from ur_nodes.pictures.feed import PictureFeed
from ur_nodes.ports.values import PackedPicture

BOARD = Board()
VIEWS = project_views(BOARD)
TOPIC = "/left/image/compressed"


class Camera:
    """A camera on a bus, and the session that sees its pictures."""

    def __init__(self, views: int = 0) -> None:
        self.bus = Bus()
        self.session = CalibrationSession(BOARD, VIEWS[:views])
        self.views = Views(PictureFeed(self.bus.node("calibrate_camera"), "left/image"), self.session)

    def show(self, *pictures: bytes) -> None:
        publisher = self.bus.node("left").publish(TOPIC, PackedPicture)
        for picture in pictures:
            publisher.send(PackedPicture(0, "left", "jpeg", picture))
            self.bus.run(0.1)
            self.views.pop()


def test_board_that_is_held_still_becomes_a_view_and_each_picture_counts_once() -> None:
    camera, picture = Camera(), encode(Studio(BOARD).take(*next(list_poses())))
    camera.show(picture)
    assert camera.session.event == "hold the board still"
    assert camera.views.pop() is None
    assert camera.session.views == []
    camera.show(picture)
    assert camera.session.event == "view 1 is taken"


def test_picture_that_is_broken_is_named() -> None:
    camera, picture = Camera(), encode(Studio(BOARD).take(*next(list_poses())))
    camera.show(picture[:-2000])
    assert camera.views.explain_silence().startswith(f"{TOPIC}: ")
    camera.show(picture)
    assert camera.views.explain_silence() == ""


def test_lines_name_the_missing_camera_and_end_with_q(capsys: pytest.CaptureFixture[str]) -> None:
    camera = Camera()
    camera.bus.run(4.0)
    source, sink = os.pipe()
    os.write(sink, b"q\n")
    assert not write_session(camera.views, threading.Event(), source)
    os.close(sink)
    os.close(source)
    assert capsys.readouterr().out == f"no picture on {TOPIC}: no node publishes it\n"


def test_views_that_suffice_complete_the_session_without_a_key() -> None:
    camera = Camera(len(VIEWS))
    assert write_session(camera.views, threading.Event(), -1)


@pytest.mark.parametrize(("views", "key", "complete"), [(3, "c", True), (3, "q", False), (2, "\x03", False)])
def test_c_calibrates_from_three_views_on_and_q_and_ctrl_c_leave(views: int, key: str, complete: bool) -> None:
    camera, results = Camera(views), list[bool]()
    with TypedTerminal(
        lambda terminal, ended: results.append(show_session(terminal, camera.views, ended, rich=True))
    ) as screen:
        screen.wait_for(f"{views} of ")
        assert ("c calibrates" in screen.text) == (views > 2)
        screen.type(key)
        screen.wait_end()
    assert results == [complete]
