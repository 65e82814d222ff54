from pathlib import Path

from ur.get.install import make_offer


def test_names_that_no_package_can_have_are_left_out() -> None:
    offered = make_offer(["rover", "$(rm)", "base"])
    assert offered is not None
    assert offered.names == ("base", "rover")
    assert offered.question == "base, rover are missing; find out where to get that?"
    assert offered.help.startswith("ur get base rover prints how to get what is missing")
    assert make_offer(["$(rm)"]) is None


def test_packages_that_are_found_are_counted(tmp_path: Path) -> None:
    offered = make_offer(["rover_bringup"])
    assert offered is not None
    environment = {"ROS_PACKAGE_PATH": str(tmp_path), "HOME": str(tmp_path)}
    assert offered.count_installed(environment) == 0
    (tmp_path / "rover_bringup").mkdir()
    (tmp_path / "rover_bringup/package.xml").write_text("<package><name>rover_bringup</name></package>")
    assert offered.count_installed(environment) == 1
