"""Tags and attributes of launch files: all names, where they are allowed, and their meaning."""

from collections.abc import Mapping, Sequence

from ur.launchfile.plan.tags.arguments import ARG_ATTRIBUTES
from ur.launchfile.plan.tags.body import GROUP_ATTRIBUTES, INCLUDE_ATTRIBUTES, TAGS
from ur.launchfile.plan.tags.nodes import NODE_ATTRIBUTES, TEST_ATTRIBUTES
from ur.launchfile.plan.tags.params import PARAM_ATTRIBUTES, ROSPARAM_ATTRIBUTES
from ur.launchfile.plan.tags.simple import MACHINE_ATTRIBUTES

CONDITIONS = ("if", "unless")
ATTRIBUTES: Mapping[str, Sequence[str]] = {
    "arg": ARG_ATTRIBUTES,
    "env": ("name", "value"),
    "group": GROUP_ATTRIBUTES,
    "include": INCLUDE_ATTRIBUTES,
    "machine": MACHINE_ATTRIBUTES,
    "node": NODE_ATTRIBUTES,
    "param": PARAM_ATTRIBUTES,
    "remap": ("from", "to"),
    "rosparam": ROSPARAM_ATTRIBUTES,
    "test": TEST_ATTRIBUTES,
}
_IN_NODE = ("remap", "param", "rosparam", "env")
INSIDE: Mapping[str, Sequence[str]] = {
    "": ("launch",),
    "launch": TAGS,
    "group": TAGS,
    "include": ("arg", "env"),
    "node": _IN_NODE,
    "test": _IN_NODE,
}
REQUIRED: Mapping[str, Sequence[str]] = {
    "arg": ("name",),
    "env": ("name", "value"),
    "include": ("file",),
    "machine": ("name", "address"),
    "node": ("name", "pkg", "type"),
    "param": ("name",),
    "remap": ("from", "to"),
    "test": ("test-name", "pkg", "type"),
}
_TRUTH = ("true", "false")
_OPTIONAL_TRUTH: Mapping[str, Sequence[str]] = dict.fromkeys(
    ("clear_params", "pass_all_args", "required", "respawn", "subst_value", "if", "unless"), _TRUTH
)
_CHOICES: Mapping[tuple[str, str], Sequence[str]] = {
    ("node", "output"): ("log", "screen"),
    ("test", "output"): ("log", "screen"),
    ("node", "cwd"): ("ROS_HOME", "node"),
    ("test", "cwd"): ("ROS_HOME", "node"),
    ("param", "type"): ("str", "int", "double", "bool", "yaml"),
    ("rosparam", "command"): ("load", "dump", "delete"),
    ("machine", "default"): (*_TRUTH, "never"),
}
DOCUMENTS: Mapping[str, str] = {
    "arg": "An argument of this file, or inside `<include>` a value that is passed.",
    "env": "An environment variable of the nodes that follow.",
    "group": "Tags with a common namespace or condition.",
    "include": "Takes in another launch file.",
    "launch": "The root element of a launch file.",
    "machine": "A computer that nodes may run on.",
    "node": "A program to start.",
    "param": "Sets one parameter.",
    "remap": "Gives a name another one in the nodes that follow.",
    "rosparam": "Loads, dumps or deletes parameters as YAML.",
    "test": "A node that `rostest` starts as a test.",
    "args": "Arguments of the node's command line.",
    "clear_params": "Deletes the parameters of the namespace before any is set.",
    "command": "A program whose output is the value; of `<rosparam>`: load, dump or delete.",
    "cwd": "The working folder of the node.",
    "default": "The value unless another is given.",
    "doc": "A line about the argument.",
    "file": "The path of a file; `$(find PACKAGE)` is the folder of a package.",
    "from": "The name in the node's code.",
    "if": "The tag takes part only if this is true.",
    "launch-prefix": "Words before the node's command, such as `gdb --args`.",
    "name": "The name.",
    "ns": "The namespace.",
    "output": "`screen` shows the node's output, `log` keeps it in a file.",
    "pass_all_args": "Passes all arguments of this file that the included one declares.",
    "pkg": "The package that holds the program.",
    "required": "The whole run ends with this node.",
    "respawn": "The node is started again when it ends.",
    "to": "The name that is used instead.",
    "type": "The program of a node; of `<param>`: the type of the value.",
    "unless": "The tag takes part only if this is false.",
    "value": "The value, which nothing that is given replaces.",
}


def find_choices(tag: str, attribute: str) -> Sequence[str]:
    """Return the values that an attribute may have, if they are known."""
    return _CHOICES.get((tag, attribute)) or _OPTIONAL_TRUTH.get(attribute, ())
