import random

import pytest
from tests.ur_nodes.drivers.sensor_mutations import ATTACKS


@pytest.mark.parametrize("name", sorted(ATTACKS))
def test_damaged_data_raise_nothing_and_leave_the_reader_able_to_read(name: str) -> None:
    ATTACKS[name](1000, random.Random(1))
