"""The serial line and the I2C bus of a Raspberry Pi's header: what is added to the firmware's files, and taken back."""

import pytest

from ur.devices.known import Expected
from ur.robot.setup.change import Change
from ur.robot.setup.facts import ABSENT, ComputerFacts, FileState
from ur.robot.setup.raspberry_pi.header import FILES, MODEL, MODULES, list_missing, want_header
from ur.robot.setup.wanted import WantedFile
from ur.robot.ssh.secret import Secret

BOARD = (Expected("base", "serial", "/dev/ttyAMA0", "pi-uart", 38400),)
CONFIG, COMMAND = "/boot/firmware/config.txt", "/boot/firmware/cmdline.txt"
LINE = "console=serial0,115200 console=tty1 root=PARTUUID=1-02 rootwait\n"


PI_4 = "Raspberry Pi 4 Model B Rev 1.4\0"


def facts(config: str | None = "arm_64bit=1\n", command: str = LINE, model: str = PI_4) -> ComputerFacts:
    files = {
        **dict.fromkeys(FILES, ABSENT),
        MODULES: ABSENT,
        MODEL: FileState(model),
        COMMAND: FileState(command, 0o755),
    }
    if config is not None:
        files[CONFIG] = FileState(config, 0o755)
    return ComputerFacts("ros", "/home/ros", "bob", "debian", "1", frozenset(), files=files)


def texts(change: Change | None) -> list[str]:
    assert change
    return [each.stdin.reveal() if isinstance(each.stdin, Secret) else each.stdin for each in change.commands]


def test_motor_board_gets_the_serial_line_and_the_console_leaves_it() -> None:
    seen = facts()
    (item,) = want_header(seen, BOARD)
    change = item.plan(seen)
    assert change
    config, command = texts(change)
    assert config.startswith("arm_64bit=1\n# Written by ur robot setup")
    assert config.endswith("[all]\n# cmdline.txt had: console=serial0,115200\nenable_uart=1\ndtoverlay=disable-bt\n")
    assert command == "console=tty1 root=PARTUUID=1-02 rootwait\n"
    assert change.note == "from the next boot on"
    assert all(each.root for each in change.commands)
    after = facts(config, command)
    assert item.plan(after) is None
    assert texts(item.undo(after)) == ["arm_64bit=1\n", LINE]
    assert item.undo(seen) is None


def test_lines_that_were_added_after_ours_stay_when_ours_are_taken_back() -> None:
    seen = facts()
    (item,) = want_header(seen, BOARD)
    config, command = texts(item.plan(seen))
    assert texts(item.undo(facts(f"{config}gpu_mem=64\n", command)))[0] == "arm_64bit=1\ngpu_mem=64\n"


@pytest.mark.parametrize(
    ("config", "model", "missing"),
    [
        ("", "Raspberry Pi 3 Model B Plus", ["enable_uart=1", "dtoverlay=disable-bt"]),
        ("enable_uart=1\ndtoverlay=miniuart-bt # mine\n", "Raspberry Pi 4 Model B", []),
        ("[pi3]\nenable_uart=1\n[all]\ndtoverlay=disable-bt\n", "Raspberry Pi 4 Model B", ["enable_uart=1"]),
        ("# enable_uart=1\ndtoverlay=disable-bt\n", "Raspberry Pi 4 Model B", ["enable_uart=1"]),
        ("enable_uart=1\n", "Raspberry Pi 5 Model B", ["dtparam=uart0=on"]),
        ("dtparam=uart0=on\n", "Raspberry Pi Compute Module 5", []),
    ],
)
def test_lines_that_are_missing_depend_on_the_model_and_on_what_the_user_has(
    config: str, model: str, missing: list[str]
) -> None:
    assert list_missing(config, model) == missing


def test_other_computers_other_boards_and_a_card_without_these_files_are_left_alone() -> None:
    assert want_header(facts(), (Expected("base", "serial", "/dev/create", "create"),)) == []
    assert want_header(facts(model="Radxa ROCK 4\0"), BOARD) == []
    assert want_header(facts(config=None), BOARD) == []
    ready = facts("enable_uart=1\ndtoverlay=disable-bt\n", "console=tty1 rootwait\n")
    (item,) = want_header(ready, BOARD)
    assert item.plan(ready) is None
    assert item.undo(ready) is None


def test_inertial_unit_gets_the_i2c_bus_and_its_module() -> None:
    unit = (Expected("imu", "i2c", "/dev/i2c-1"),)
    seen = facts()
    module, item = want_header(seen, unit)
    assert isinstance(module, WantedFile)
    assert (module.path, module.text) == (MODULES, "i2c-dev\n")
    (config,) = texts(item.plan(seen))
    assert config.startswith("arm_64bit=1\n# Written by ur robot setup: the I2C bus of the header.\n[all]\n")
    assert config.endswith("dtparam=i2c_arm=on\n")
    after = facts(config + "gpu_mem=64\n")
    assert item.plan(after) is None
    assert texts(item.undo(after)) == ["arm_64bit=1\ngpu_mem=64\n"]
    assert item.plan(facts("dtparam=i2c=on\n")) is None
    assert item.undo(seen) is None
    assert [each.title for each in want_header(facts(model="Radxa ROCK 4\0"), unit)] == ["module of I2C buses"]


def test_board_and_inertial_unit_are_set_up_and_undone_in_one_step() -> None:
    both = (*BOARD, Expected("imu", "i2c", "/dev/i2c-1"))
    seen = facts()
    _, item = want_header(seen, both)
    config, command = texts(item.plan(seen))
    after = facts(config, command)
    assert item.plan(after) is None
    assert texts(item.undo(after)) == ["arm_64bit=1\n", LINE]
