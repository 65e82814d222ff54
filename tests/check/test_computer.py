from pathlib import Path

from ur.check.worlds import make_world


def test_every_package_of_a_large_workspace_is_found(tmp_path: Path) -> None:
    for number in range(600):
        (tmp_path / f"package_{number}").mkdir()
        (tmp_path / f"package_{number}" / "package.xml").write_text(f"<package><name>package_{number}</name></package>")
    assert make_world([str(tmp_path)], {}).find_package("package_99") == str(tmp_path / "package_99")
    assert make_world([str(tmp_path / "package_1")], {}).find_package("package_99") == str(tmp_path / "package_99")
