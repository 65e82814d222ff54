from pathlib import Path

import pytest

from ur.robot.image.device import check_device
from ur.source.diagnostic import UserError


class ComputerWithDisks:
    """What the kernel tells about a computer with one disk and one card, as files."""

    def __init__(self, folder: Path) -> None:
        self.system, self.processes, self.devices = folder / "sys", folder / "proc", folder / "dev"
        self.write("proc/self/mountinfo", "")
        self.write("proc/swaps", "Filename Type\n")
        for name, number, size in (("sda", "8:0", 1000), ("sdb", "8:16", 62333952), ("sdc", "8:32", 0)):
            self.write(f"dev/{name}", "x")
            self.write(f"sys/devices/{name}/dev", number)
            self.write(f"sys/devices/{name}/size", f"{size}\n")
            self.write(f"sys/devices/{name}/device/vendor", "Mass    \n")
            self.write(f"sys/devices/{name}/device/model", "Storage Device  \n")
            for part in (1, 2):
                inner = f"sys/devices/{name}/{name}{part}"
                self.write(f"{inner}/dev", f"{number.split(':')[0]}:{int(number.split(':')[1]) + part}")
                self.write(f"{inner}/partition", str(part))
                self.link(f"{name}{part}", f"{name}/{name}{part}")
            self.link(name, name)

    def link(self, name: str, target: str) -> None:
        place = self.system / "class/block" / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.symlink_to(self.system / "devices" / target)

    def write(self, path: str, text: str) -> None:
        place = self.system.parent / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text)

    def mount(self, number: str, where: str) -> None:
        self.write("proc/self/mountinfo", f"28 1 {number} / {where} rw,relatime shared:1 - ext4 /dev/x rw\n")

    def check(self, name: str) -> str:
        return str(check_device(self.devices / name, system=self.system, processes=self.processes))

    def refuse(self, name: str) -> tuple[str, str]:
        with pytest.raises(UserError) as caught:
            self.check(name)
        return str(caught.value), caught.value.diagnostics[0].help or ""


@pytest.fixture
def computer(tmp_path: Path) -> ComputerWithDisks:
    return ComputerWithDisks(tmp_path)


def test_card_is_called_by_its_model_and_size(computer: ComputerWithDisks) -> None:
    assert computer.check("sdb").endswith("sdb (Mass Storage Device, 31.9 GB)")


def test_partition_is_refused_with_the_name_of_its_disk(computer: ComputerWithDisks) -> None:
    computer.write("dev/sdb1", "x")
    assert "is a partition, expected a whole disk: /dev/sdb" in computer.refuse("sdb1")[0]


def test_disk_of_this_computer_is_refused(computer: ComputerWithDisks) -> None:
    computer.mount("8:1", "/")
    assert "this computer's own system" in computer.refuse("sda")[0]
    assert computer.check("sdb")


def test_mounted_card_comes_with_the_command_that_unmounts_it(computer: ComputerWithDisks) -> None:
    computer.mount("8:18", "/media/pat/writable\\040two")
    said, help = computer.refuse("sdb")
    assert "is mounted (/dev/sdb2 at /media/pat/writable two)" in said
    assert help == "run: sudo umount /dev/sdb2"


def test_disk_below_a_volume_or_a_swap_is_refused(computer: ComputerWithDisks) -> None:
    computer.write("sys/devices/sda/sda2/holders/dm-0/x", "")
    assert "/dev/sda2 is in use by this computer (dm-0)" in computer.refuse("sda")[0]
    computer.write("proc/swaps", "Filename Type\n/dev/sdb1 partition 1 0 -2\n")
    assert "/dev/sdb1 is in use by this computer (swap)" in computer.refuse("sdb")[0]


def test_reader_without_a_card_is_named(computer: ComputerWithDisks) -> None:
    assert "is empty, expected a card in it" in computer.refuse("sdc")[0]
