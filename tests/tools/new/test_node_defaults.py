import pytest

from ur.tools.new.node_defaults import add_defaults, read_defaults
from ur.tools.new.parts import Observed


def test_literal_defaults_of_private_parameters_are_read() -> None:
    source = 'near = rospy.get_param("~near", 0.7)\nnames = get_param("~limits/names", default=["a"])\n'
    assert read_defaults(source) == {"near": 0.7, "limits/names": ["a"]}


def test_defaults_of_a_node_on_ports_are_read() -> None:
    source = (
        'own = node.parameters\nown.number("near", 0.7, minimum=0.1)\nown.text("frame", default="map")\nown.any("x")'
    )
    assert read_defaults(source) == {"near": 0.7, "frame": "map"}


@pytest.mark.parametrize(
    "source",
    [
        'rospy.get_param("~near")',  # no default
        'rospy.get_param("near", 0.7)',  # not a parameter of the node itself
        'rospy.get_param("~near", NEAR)',  # computed
        'rospy.get_param("~" + name, 0.7)',
        'rospy.get_param("~near", 0.7); rospy.get_param("~near", 0.8)',  # which of the two is unknown
        "#!/bin/sh\nexec x",
        "\0",
        "(" * 10_000,
    ],
)
def test_defaults_that_cannot_be_known_are_left_out(source: str) -> None:
    assert read_defaults(source) == {}


def test_default_fills_only_a_parameter_without_value() -> None:
    observed = Observed(parameters={"near": None, "rate": 5, "frame": None})
    assert add_defaults(observed, {"near": 0.7, "rate": 10, "unused": 1}).parameters == {
        "near": 0.7,
        "rate": 5,
        "frame": None,
    }
