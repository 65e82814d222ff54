import copy
import dataclasses
import pickle
from typing import Any, ClassVar

import pytest

from ur.source import data_classes


def make_classes(kind: Any) -> tuple[Any, Any]:
    @kind.dataclass(frozen=True, slots=True)
    class Pose:
        title: ClassVar[str] = "pose"
        x: float
        y: float = 0.0
        names: dict[str, int] = kind.field(default_factory=dict, compare=False, repr=False)

        @property
        def sum(self) -> float:
            return self.x + self.y

    @kind.dataclass(frozen=True, slots=True)
    class Stamped(Pose):
        stamp: int = kind.field(default=7)

    return Pose, Stamped


@dataclasses.dataclass(frozen=True, slots=True)
class Standard:
    x: float
    y: float = 0.0


@data_classes.dataclass(frozen=True, slots=True)
class Ours:
    x: float
    y: float = 0.0


@data_classes.dataclass(slots=True)
class Changing:
    count: int = 0
    texts: list[str] = data_classes.field(default_factory=list)


def describe(kind: Any) -> list[object]:
    pose, stamped = make_classes(kind)
    one, other = pose(1.0, names={"a": 1}), stamped(1.0, 2.0, stamp=8)
    return [
        repr(one),
        repr(other),
        one == pose(1.0),
        one == pose(2.0),
        one == stamped(1.0),
        one != other,
        hash(one) == hash(pose(1.0)),
        {one: 1}[pose(1.0)],
        other.sum,
        pose.title,
        pose.__slots__,
        stamped.__slots__,
        stamped.__match_args__,
        kind.replace(other, y=3.0).sum,
        dataclasses.replace(other, y=3.0).stamp,
        dataclasses.asdict(one),
        [(each.name, each.default, each.compare) for each in dataclasses.fields(stamped)],
        dataclasses.is_dataclass(one),
        pose(1.0).names is not pose(1.0).names,
        hasattr(one, "__dict__"),
    ]


def test_data_classes_behave_as_those_of_the_standard_library() -> None:
    assert [str(each).replace("dataclasses", "data_classes") for each in describe(data_classes)] == [
        str(each).replace("dataclasses", "data_classes") for each in describe(dataclasses)
    ]


@pytest.mark.parametrize("kind", [Standard, Ours])
def test_frozen_values_refuse_changes_and_wrong_arguments_and_can_be_copied(kind: Any) -> None:
    value = kind(1.0, y=2.0)
    with pytest.raises(dataclasses.FrozenInstanceError):
        value.x = 3.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        del value.x
    for arguments in ((), (1.0, 2.0, 3.0)):
        with pytest.raises(TypeError):
            kind(*arguments)
    with pytest.raises(TypeError):
        kind(1.0, z=1.0)
    assert value == pickle.loads(pickle.dumps(value)) == copy.copy(value) == copy.deepcopy(value)
    match value:
        case Standard(x, y) | Ours(x, y):
            assert (x, y) == (1.0, 2.0)


def test_values_that_are_not_frozen_change_and_have_no_hash() -> None:
    value = Changing()
    value.count += 1
    value.texts.append("a")
    assert value == Changing(1, ["a"])
    assert Changing().texts == []
    with pytest.raises(TypeError):
        hash(value)


def test_a_data_class_of_the_standard_library_may_extend_one() -> None:
    @dataclasses.dataclass(frozen=True, slots=True)
    class Stamped(Ours):
        stamp: int = 1

    assert data_classes.replace(Stamped(1.0, stamp=2), y=5.0) == Stamped(1.0, 5.0, 2)


@pytest.mark.parametrize("given", [{"x": []}, {"x": data_classes.field(init=False)}, {"__post_init__": print}])
def test_what_data_classes_do_not_know_is_refused_and_not_left_out(given: dict[str, object]) -> None:
    with pytest.raises(AssertionError):
        data_classes.dataclass(slots=True)(type("Class", (), {"__annotations__": {"x": int}, **given}))
