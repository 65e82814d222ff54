from pathlib import Path

import pytest
from tests.robot.image.images import (
    BOOT,
    MIB,
    Part,
    make_cloud,
    make_filesystem,
    make_image,
    make_old_raspberry,
    make_raspberry,
    make_ubuntu,
    needs_tools,
    os_release,
    run,
)

from ur.robot.image.layout import Scheme, find_layout
from ur.source.diagnostic import UserError

pytestmark = needs_tools


def refusal(path: Path) -> str:
    with pytest.raises(UserError) as caught:
        find_layout(path)
    return str(caught.value)


def test_ubuntu_for_raspberry_pi_has_its_seed_on_system_boot(tmp_path: Path) -> None:
    found = find_layout(make_ubuntu(tmp_path / "x.img", netplan="1.0-2ubuntu1"))
    assert (found.scheme, found.system, found.raspberry) == (Scheme.BOOT_SEED, "Ubuntu 22.04.5 LTS", False)
    assert found.netplan == "1.0-2ubuntu1"


def test_writing_that_was_cut_off_between_two_names_is_recognized(tmp_path: Path) -> None:
    path = make_ubuntu(tmp_path / "x.img")
    run("mren", "-i", f"{path}@@{BOOT}M", "::/user-data", "::/user-data.ur-new")
    assert find_layout(path).scheme is Scheme.BOOT_SEED


def test_raspberry_pi_os_13_has_cloud_init(tmp_path: Path) -> None:
    found = find_layout(make_raspberry(tmp_path / "x.img"))
    assert (found.scheme, found.raspberry) == (Scheme.BOOT_SEED, True)


def test_raspberry_pi_os_12_has_custom_toml(tmp_path: Path) -> None:
    found = find_layout(make_old_raspberry(tmp_path / "x.img"))
    assert (found.scheme, found.system) == (Scheme.CUSTOM_TOML, "Debian GNU/Linux 12 (bookworm)")


def test_raspberry_pi_os_12_that_has_booted_is_refused(tmp_path: Path) -> None:
    said = refusal(make_old_raspberry(tmp_path / "x.img", command="console=tty1 root=PARTUUID=4d3f-02\n"))
    assert "booted before" in said
    assert "bookworm" in said


def test_cloud_image_has_its_seed_in_the_system(tmp_path: Path) -> None:
    found = find_layout(make_cloud(tmp_path / "x.img"))
    assert (found.scheme, found.boot) == (Scheme.ROOT_SEED, None)


def test_disk_labelled_cidata_needs_no_partitions(tmp_path: Path) -> None:
    path = make_filesystem(tmp_path / "x.img", Part("fat", "CIDATA"))
    assert find_layout(path).scheme is Scheme.BOOT_SEED


def test_system_without_cloud_init_is_named(tmp_path: Path) -> None:
    path = make_image(tmp_path / "x.img", [Part("ext", "root", os_release("Arch Linux"))])
    assert "x.img: Arch Linux without cloud-init, expected" in refusal(path)


def test_disk_of_another_system_is_described(tmp_path: Path) -> None:
    path = make_image(tmp_path / "x.img", [Part("fat", "PHOTOS", {"a.txt": "x"}), Part("none")])
    assert "1: fat PHOTOS, 2: unknown" in refusal(path)


def test_file_system_that_was_not_unmounted_is_refused(tmp_path: Path) -> None:
    path = make_cloud(tmp_path / "x.img")
    with path.open("r+b") as file:  # the superblock's flag for a journal that has to be replayed
        file.seek(10 * MIB + 1024 + 96)
        flags = int.from_bytes(file.read(4), "little")
        file.seek(10 * MIB + 1024 + 96)
        file.write((flags | 4).to_bytes(4, "little"))
    assert "not unmounted" in refusal(path)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "an empty file"),
        (b"hello\n", "a text"),
        (bytes(8192), "an empty disk"),
        (b"QFI\xfb" + bytes(600), "a qcow2 disk of QEMU"),
        (bytes(32769) + b"CD001" + bytes(600), "an image of a CD or DVD"),
        (bytes(range(256)) * 20, "something without partitions"),
    ],
)
def test_what_is_no_image_is_named(tmp_path: Path, content: bytes, said: str) -> None:
    path = tmp_path / "x.img"
    path.write_bytes(content)
    assert f"x.img: {said}" in refusal(path)


def test_qcow2_disk_comes_with_the_command_that_converts_it(tmp_path: Path) -> None:
    path = tmp_path / "x.img"
    path.write_bytes(b"QFI\xfb" + bytes(600))
    with pytest.raises(UserError) as caught:
        find_layout(path)
    assert "qemu-img convert -O raw" in (caught.value.diagnostics[0].help or "")
