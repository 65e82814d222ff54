from pathlib import Path

import pytest

from ur.launchfile.world.system import SystemWorld
from ur.request.bases.base_argument import describe_lack, describe_need, find_variants, list_lacks, read_needs
from ur.request.programs import PACKAGE
from ur.robot.base import Base, load_base


@pytest.fixture
def stage() -> Base:
    return load_base(PACKAGE, "stage")


def test_needs_stand_in_a_comment_of_the_launch_file(tmp_path: Path) -> None:
    path = tmp_path / "m.launch"
    path.write_text("<launch><!--Summary: x--><!--Needs: raspicam, lidar|sonars--><group/></launch>")
    assert read_needs(str(path), SystemWorld({})) == (("raspicam",), ("lidar", "sonars"))


def test_file_that_cannot_be_read_needs_nothing(tmp_path: Path) -> None:
    assert read_needs(str(tmp_path / "none"), SystemWorld({})) == ()


def test_one_of_the_alternatives_is_enough(stage: Base) -> None:
    assert list_lacks(stage, [("lidar",), ("sonars", "lidar")]) == ()
    assert list_lacks(stage, [("sonars",), ("lidar",)]) == (("sonars",),)


def test_lacks_are_told_with_the_base_and_its_variant() -> None:
    magni = load_base(PACKAGE, "magni", "lidar")
    assert describe_lack(magni, [("bumpers",)]) == "magni:lidar has no bumpers"
    assert describe_need(("lidar", "sonars")) == "a lidar or sonars"


def test_variants_that_have_what_is_needed_are_found() -> None:
    magni = load_base(PACKAGE, "magni")
    assert find_variants(PACKAGE, magni, [("lidar",)]) == ("lidar",)
    assert find_variants(PACKAGE, magni, [("raspicam",)]) == ("", "lidar")


def test_every_need_of_the_library_is_something_that_a_base_may_have(stage: Base) -> None:
    files = sorted(PACKAGE.glob("*/launch/*.launch.xml"))
    names = {name for path in files for need in read_needs(str(path), SystemWorld({})) for name in need}
    assert {"lidar", "raspicam", "sonars"} <= names
    assert all(hasattr(stage, name) for name in names)
