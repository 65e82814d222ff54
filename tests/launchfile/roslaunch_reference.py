"""The installed roslaunch as an oracle: a program that loads launch files and says what it made of them.

Reads one JSON request per line and answers each with one line; see `Reference` in conftest.py.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from typing import Any

CORE = '<launch><group ns="/"><node pkg="rosout" type="rosout" name="rosout" respawn="true"/></group></launch>'


def _serve() -> None:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # roslaunch prints as it pleases
    import rosgraph.names
    import roslaunch.config
    import roslaunch.loader
    import roslaunch.substitution_args
    import roslaunch.xmlloader
    import yaml

    with tempfile.NamedTemporaryFile("w", suffix=".xml") as core:
        core.write(CORE)
        core.flush()
        # The installed core file runs two programs for two parameters that say nothing about the file in question.
        roslaunch.config.load_roscore = lambda loader, config, verbose=True: loader.load(
            core.name, config, core=True, verbose=verbose
        )
        roslaunch.config.is_machine_local = lambda _machine: True  # asks the network
        rosgraph.names.anonymous_name = lambda prefix: f"{prefix}_anonymous"
        constructors = dict(yaml.SafeLoader.yaml_constructors)
        resolvers = {key: list(value) for key, value in yaml.SafeLoader.yaml_implicit_resolvers.items()}
        for line in sys.stdin:
            request = json.loads(line)
            os.environ.clear()
            os.environ.update(request["environment"])
            # Each request is a fresh roslaunch: forget packages, and the YAML types that rosparam registers.
            roslaunch.substitution_args._rospack = None
            roslaunch.loader.rosparam = None
            sys.modules.pop("rosparam", None)
            yaml.SafeLoader.yaml_constructors = dict(constructors)
            yaml.SafeLoader.yaml_implicit_resolvers = {key: list(value) for key, value in resolvers.items()}
            sys.argv = ["roslaunch", *request["files"], *request["arguments"]]
            try:
                config = roslaunch.config.load_config_default(request["files"], None, verbose=False)
                answer = _describe(config, core.name)
                text = json.dumps(answer, default=str)
            except BaseException as problem:  # a traceback is a refusal too
                text = json.dumps({"ok": False, "error": f"{type(problem).__name__}: {problem}"})
            answers.write(text + "\n")
            answers.flush()


def _describe(config: Any, core: str) -> dict[str, Any]:
    from ur.launchfile.dump import plain_value

    def name(key: Any) -> str:
        return json.dumps(key) if key is None or isinstance(key, bool) else str(key)

    def value(item: Any) -> Any:
        if isinstance(item, list):
            return [value(part) for part in item]
        if isinstance(item, dict):
            return {name(key): value(part) for key, part in item.items()}
        return plain_value(getattr(item, "data", item))

    return {
        "ok": True,
        "nodes": sorted((_describe_node(node) for node in config.nodes), key=lambda node: str(node["name"])),
        "tests": sorted(
            (
                {
                    **_describe_node(test),
                    "test_name": test.test_name,
                    "time_limit": test.time_limit,
                    "retry": test.retry,
                }
                for test in config.tests
            ),
            key=lambda test: (str(test["name"]), str(test["test_name"])),
        ),
        "params": {name: value(param.value) for name, param in config.params.items()},
        "clear_params": sorted(config.clear_params),
        "machines": {
            machine.name: {
                "address": machine.address,
                "user": machine.user,
                "env_loader": machine.env_loader,
                "ssh_port": machine.ssh_port,
                "timeout": machine.timeout,
            }
            for machine in config.machines.values()
            if machine.name
        },
        "files": sorted(
            {os.path.abspath(path) for path in config.roslaunch_files} - {core}  # noqa: PTH100 - as we do it
        ),
        "commands": [list(command.args) for command in config.executables],
        "warnings": len(config.config_errors),
    }


def _describe_node(node: Any) -> dict[str, Any]:
    import rosgraph.names

    return {
        "name": rosgraph.names.ns_join(node.namespace, node.name) if node.name else None,
        "package": node.package,
        "type": node.type,
        "args": " ".join(node.args.split()),
        "machine": node.machine_name,
        "respawn": node.respawn,
        "respawn_delay": node.respawn_delay,
        "required": node.required,
        "output": node.output or "log",
        "cwd": node.cwd,
        "launch_prefix": node.launch_prefix,
        "remaps": sorted(list(remap) for remap in node.remap_args),
        "env": dict(node.env_args),
    }


if __name__ == "__main__":
    _serve()
