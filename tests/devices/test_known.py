"""The table of known devices, and what it says about a device."""

import pytest

from ur.devices.known import Device, describe_device, find_known, find_rows, load_known, parse_known

HEAD = "id\tmatch\tproduct\tkind\tstable\tbaud\tsure\twhat\tsource\n"


def test_every_row_has_a_source_and_a_name_that_only_one_kind_of_device_gets() -> None:
    rows = load_known()
    assert all(row.source and row.what for row in rows)
    names = {(row.id, row.stable) for row in rows if row.stable}
    assert len({name for _, name in names}) == len(names)


def test_chip_that_many_devices_have_makes_a_guess_only() -> None:
    bridge = Device("/dev/ttyUSB0", "serial", "10c4:ea60", product="CP2102")
    assert describe_device(bridge).startswith("probably Slamtec RPLIDAR")
    assert describe_device(bridge).endswith("(CP2102)")
    assert describe_device(Device("/dev/ttyACM0", "serial", "2108:780b")) == "Neato Botvac or XV-11"


def test_product_text_decides_between_devices_of_one_id() -> None:
    kobuki = Device("/dev/ttyUSB0", "serial", "0403:6001", serial="kobuki_A601D86G")
    assert [row.id for row in find_known(kobuki)] == ["kobuki"]
    assert [row.id for row in find_known(Device("/dev/ttyUSB0", "serial", "0403:6001"))] == ["create"]


def test_unknown_device_is_called_what_it_calls_itself() -> None:
    assert describe_device(Device("/dev/ttyACM3", "serial", "dead:beef", product="Toaster")) == "Toaster"
    assert describe_device(Device("/dev/ttyS4", "serial")) == "serial device"


def test_device_with_several_ids_has_several_rows() -> None:
    assert len(find_rows("f310")) == 2


@pytest.mark.parametrize(
    "row", ["a\tb\n", "a\t1:2\t-\ttoaster\t-\t-\tyes\tx\ty\n", "a\t1:2\t-\thid\t-\tx\tyes\tx\ty\n"]
)
def test_malformed_table_is_named_with_its_line(row: str) -> None:
    with pytest.raises(ValueError, match=r"known_devices\.tsv:2"):
        parse_known(HEAD + row)


def test_table_without_its_columns_is_refused() -> None:
    for text in ("", "# nothing\n", "match\tname\n"):
        with pytest.raises(ValueError, match=r"known_devices\.tsv: expected the columns "):
            parse_known(text)
