"""`<remap>`, `<env>` and `<machine>`."""

# Paths are texts here: pathlib would change what roslaunch prints, and costs too much in hot loops.
# ruff: noqa: PTH118

import os

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.names import canonical_name, is_legal_name
from ur.launchfile.plan.problems import refuse
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import MachineSpec, RemapStep
from ur.launchfile.plan.tags.attributes import as_number, check_attributes, read_optional, read_required
from ur.launchfile.syntax import Element
from ur.launchfile.world.protocol import World
from ur.source.diagnostic import Note

MACHINE_ATTRIBUTES = ("name", "address", "env-loader", "ssh-port", "user", "password", "default", "timeout")
DEFAULT_TIMEOUT = 10.0
_NO_LONGER = ("ros-root", "ros-package-path", "ros-ip", "ros-hostname")


def read_remap(element: Element, draft: Draft, scope: Scope) -> tuple[str, str]:
    """Return the two names of a `<remap>`. Raises TagRefused."""
    check_attributes(element, ("from", "to"), draft, scope)
    names = [canonical_name(read_required(element, name, draft, scope)) for name in ("from", "to")]
    for attribute, name in zip(("from", "to"), names, strict=True):
        if not name:
            raise refuse(
                f"'{attribute}' of <remap> is empty, expected a name", element.name_span(attribute), "bad-remap"
            )
        if not is_legal_name(name):
            raise refuse(
                f"'{attribute}' of <remap> is '{name}', expected a ROS name: letters, digits, '_' and '/'",
                element.value_span(attribute),
                "bad-remap",
                "begin with a letter, '/' or '~'; use '_' where you would write '-'",
            )
    if draft.trace is not None:
        draft.trace.append(RemapStep(names[0], names[1], draft.origin(element.span, scope)))
    return names[0], names[1]


def resolve_env(element: Element, draft: Draft, scope: Scope, target: Scope) -> None:
    """Set an environment variable for the nodes of `target`. Raises TagRefused."""
    check_attributes(element, ("name", "value"), draft, scope)
    name = read_required(element, "name", draft, scope)
    value = read_required(element, "value", draft, scope)
    if not name:
        raise refuse("'name' of <env> is empty, expected a variable", element.name_span("name"), "empty-attribute")
    target.env.append((name, value))


def resolve_machine(element: Element, draft: Draft, scope: Scope) -> MachineSpec | None:
    """Add a `<machine>`; return it if it becomes the default. Raises TagRefused."""
    for name in _NO_LONGER:
        if read_optional(element, name, draft, scope):
            raise refuse(
                f"'{name}' of <machine> is not supported since ROS Fuerte, expected env-loader",
                element.name_span(name),
                "obsolete-machine",
                'set the environment in a script on that computer and name it with env-loader="..."',
            )
    check_attributes(element, MACHINE_ATTRIBUTES, draft, scope)
    name = read_required(element, "name", draft, scope)
    address = read_required(element, "address", draft, scope)
    loader, port, user, password, default, timeout = (
        read_optional(element, attribute, draft, scope) for attribute in MACHINE_ATTRIBUTES[2:]
    )
    ssh_port = _port(port, element)
    default = (default or "false").lower()
    if default not in ("true", "false", "never"):
        raise refuse(
            f"'default' of <machine> is '{default}', expected true, false or never",
            element.value_span("default"),
            "bad-choice",
            expected=("true", "false", "never"),
        )
    for child in element.elements:
        if child.name == "env":
            raise refuse(
                "<env> inside <machine> is not supported since ROS Fuerte, expected env-loader",
                child.span,
                "obsolete-machine",
                'set it in a script on that computer and name it with env-loader="..."',
            )
        draft.warn(f"unknown tag <{child.name}> inside <machine>, expected none", child.span, scope, "unknown-tag")
    machine = MachineSpec(
        name=name,
        address=address,
        user=user or None,
        env_loader=loader or guess_env_loader(draft.world),
        ssh_port=ssh_port,
        timeout=_timeout(timeout, element),
        origin=draft.origin(element.span, scope),
    )
    _add(machine, (password, default != "never"), element, draft)
    return machine if default == "true" else None


def guess_env_loader(world: World) -> str:
    """Return the environment script that roslaunch assumes on another computer."""
    distro = world.environment.get("ROS_DISTRO")
    if distro is None:
        path = os.path.join(world.environment.get("ROS_ETC_DIR", "/etc/ros"), "distro")
        try:
            distro = world.read_bytes(path).decode().strip() if world.is_file(path) else None
        except (OSError, UnicodeError):
            distro = None
    return f"/opt/ros/{distro}/env.sh"


def _add(machine: MachineSpec, secrets: tuple[str | None, bool], element: Element, draft: Draft) -> None:
    known = draft.machines.get(machine.name)
    if known is None and machine.name:
        draft.machines[machine.name] = machine
        draft.machine_secrets[machine.name] = secrets
        return
    same = known is not None and _facts(known) == _facts(machine)
    if not same or draft.machine_secrets[machine.name] != secrets:
        notes = (Note(f"the first '{machine.name}' is here", known.origin.span),) if known else ()
        raise refuse(
            f"a second machine is named '{machine.name}' and differs, expected one",
            element.value_span("name"),
            "duplicate-machine",
            "rename one of them, or make them equal",
            notes,
        )


def _facts(machine: MachineSpec) -> tuple[object, ...]:
    return (machine.address, machine.env_loader, machine.ssh_port, machine.user, str(machine.timeout))


def _port(text: str | None, element: Element) -> int:
    try:
        return int(text or "22")
    except ValueError:
        raise refuse(
            f"'ssh-port' of <machine> is '{text}', expected a whole number",
            element.value_span("ssh-port"),
            "bad-number",
        ) from None


def _timeout(text: str | None, element: Element) -> float:
    if text is None:
        return DEFAULT_TIMEOUT
    if not text:
        raise refuse("'timeout' of <machine> is empty, expected seconds", element.name_span("timeout"), "bad-number")
    seconds = as_number(text, element, "timeout")
    if seconds <= 0:
        raise refuse(
            f"'timeout' of <machine> is {text}, expected more than 0", element.value_span("timeout"), "bad-number"
        )
    return seconds
