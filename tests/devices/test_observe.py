"""The devices of a computer are read from what its kernel shows."""

import subprocess
from pathlib import Path

from tests.devices.tree import Tree

from ur.devices.known import DeviceSnapshot, describe_device
from ur.devices.observe import device_script, parse_devices


def look(root: Path) -> DeviceSnapshot:
    done = subprocess.run(["sh", "-c", device_script(str(root))], capture_output=True, text=True, check=True)
    return parse_devices(done.stdout, str(root))


def test_devices_are_listed_with_their_ids_names_and_holders(tmp_path: Path) -> None:
    tree = Tree(tmp_path)
    tree.plug("1-1.2", "10c4:ea60", serial="0001", product="CP2102 USB to UART", tty="ttyUSB0")
    tree.plug("1-1.3", "046d:0825", product="C270", video="video0", name="HD Webcam C270")
    tree.plug("1-1.4", "03e7:2485", product="Movidius MyriadX")
    tree.plug("1-1.5", "046d:c31c", product="a keyboard")
    tree.solder("ttyAMA0")
    tree.solder("ttyS0", kind="0")
    tree.link("rplidar", "ttyUSB0")
    tree.link("serial/by-id/usb-Silicon_Labs_CP2102_0001-if00-port0", "ttyUSB0")
    tree.open(77, "rplidarNode", "/dev/ttyUSB0")
    tree.open(88, "agetty", "", "/sbin/agetty -o -p -- \\u --noclear 115200 ttyAMA0")
    found = {device.path: device for device in look(tmp_path).devices}
    lidar = found["/dev/ttyUSB0"]
    assert (lidar.usb, lidar.serial, lidar.driver, lidar.port) == ("10c4:ea60", "0001", "cp210x", "1-1.2")
    assert lidar.stable == "/dev/rplidar"
    assert len(lidar.links) == 2
    assert [(holder.pid, holder.program) for holder in lidar.holders] == [(77, "rplidarNode")]
    assert "RPLIDAR" in describe_device(lidar)
    assert found["/dev/video0"].kind == "camera"
    assert describe_device(found["/dev/video0"]) == "Logitech C270 camera"
    assert found["/dev/ttyAMA0"].holders[0].program == "agetty"
    assert "/dev/ttyS0" not in found  # a port without a chip behind it
    assert [device.usb for device in found.values() if device.kind == "usb"] == ["03e7:2485", "046d:c31c"]


def test_gpio_chips_are_listed_where_they_have_a_device_file(tmp_path: Path) -> None:
    tree = Tree(tmp_path)
    tree.add_chip("gpiochip0")
    (tmp_path / "sys/bus/gpio/devices/gpiochip1").mkdir()
    (chip,) = look(tmp_path).devices
    assert (chip.path, chip.kind, describe_device(chip)) == ("/dev/gpiochip0", "gpio", "GPIO chip")


def test_parts_of_a_raspberry_pi_that_convert_pictures_are_no_cameras(tmp_path: Path) -> None:
    tree = Tree(tmp_path)
    tree.plug("1-1", "1d6b:0002", video="video10", name="bcm2835-codec-decode")
    assert [device for device in look(tmp_path).devices if device.kind == "camera"] == []


def test_nonsense_is_left_out() -> None:
    assert parse_devices("") == DeviceSnapshot()
    text = "\x1edevice\nclass tty\npath /etc/passwd\n"
    text += "\x1edevice\nclass tty\npath /dev/x\nusb zz\nmode 9 a b\n\x1elinks\n a\n"
    (device,) = parse_devices(text).devices
    assert (device.usb, device.mode) == ("", None)
