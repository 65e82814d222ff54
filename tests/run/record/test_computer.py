import socket
from pathlib import Path

import pytest

from ur.run.record.registry import Computer, describe_user, read_computer


def test_computer_is_known_by_its_machine_id_and_boot(tmp_path: Path) -> None:
    machine, boot = tmp_path / "machine-id", tmp_path / "boot_id"
    machine.write_text("4f1c\n")
    boot.write_text("b007\n")
    assert read_computer(str(machine), str(boot)) == Computer("4f1c", "b007", socket.gethostname())


@pytest.mark.parametrize("text", [None, "", "\n", "uninitialized\n"])
def test_computer_without_machine_id_is_known_by_its_name(tmp_path: Path, text: str | None) -> None:
    machine = tmp_path / "machine-id"
    if text is not None:
        machine.write_text(text)
    host = socket.gethostname()
    assert read_computer(str(machine), str(tmp_path / "missing")) == Computer(host, "", host)


def test_identity_for_others_does_not_contain_the_machine_id() -> None:
    one = describe_user(Computer("4f1c", "b", "laptop"), 1000)
    assert one == describe_user(Computer("4f1c", "other boot", "renamed"), 1000)
    assert one != describe_user(Computer("4f1d", "b", "laptop"), 1000)
    assert one != describe_user(Computer("4f1c", "b", "laptop"), 1001)
    assert "4f1c" not in one
