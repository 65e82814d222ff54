import pytest
from tests.ur_nodes.drivers.mutations import attack, parsers


@pytest.mark.parametrize("name", sorted(parsers()))
def test_damaged_bytes_raise_nothing_fill_no_memory_and_leave_the_parser_able_to_read(name: str) -> None:
    attack(name, 2000, 1)
