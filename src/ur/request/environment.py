"""Environment variables that follow from the selected robot: printed by `ur env`, and set by every verb."""

import os
from collections.abc import Callable, Mapping

from ur.robot.selection import Selection, load_selection, parse_selection, selection_file
from ur.source.diagnostic import UserError
from ur.source.project import library_path, state_path
from ur.source.user_folders import list_workspaces, user_folder
from ur.system.debian_root import DebianRoot, find_root
from ur.system.ros import NONE, Ros, choose_domain, facts_file, find_ros, graph_address, source_ros

CHOSEN = "UR_ROBOT"
"""The variable that names the robot for a process and its children, as `ur web ROBOT` does; it precedes the file."""

MARK = "UR_SELECTION"  # tells what `ur env` has set from what a person has set


def current_selection(environment: Mapping[str, str]) -> Selection:
    """Return the selection of the environment, else the stored one. Raises UserError if one of them is invalid."""
    if chosen := environment.get(CHOSEN):
        return parse_selection(chosen)
    return load_selection(selection_file(environment))


def watch_selection(environment: Mapping[str, str]) -> Callable[[], str]:
    """Return a function that returns the selection while nodes of it are not those of `environment`, else ""."""
    found: dict[Selection, str] = {}

    def find() -> str:
        try:
            selection = current_selection(environment)
        except UserError:
            return ""
        if selection not in found:
            there = {**environment, **environment_changes(selection, environment)}
            found[selection] = "" if graph_address(there) == graph_address(environment) else str(selection)
        return found[selection]

    return find


def environment_changes(
    selection: Selection,
    environment: Mapping[str, str],
    *,
    package: str | os.PathLike[str] = "",
    hostname: str | None = None,
    find: Callable[[Mapping[str, str]], DebianRoot | None] = find_root,
) -> dict[str, str]:
    """Return the variables to set so that `environment` follows the selection. Setting them twice changes nothing.

    A ROS_MASTER_URI or ROS_HOSTNAME that the user has set stays; one of an earlier selection is removed. `package` is
    the launch library, by default that of this project.
    """
    library = os.fspath(package) or library_path()
    host = hostname or os.uname().nodename.split(".")[0]  # importing socket would slow Tab
    root = find(environment)
    path = environment.get("PATH", os.defpath)
    wanted = {
        "ROS_PACKAGE_PATH": _package_path(environment, library),
        "PATH": _in_front(f"{library}/bin", _in_front(root.programs, path) if root else path),
        MARK: str(selection),
    }
    if workspaces := list_workspaces(environment):
        wanted["CMAKE_PREFIX_PATH"] = os.pathsep.join(workspaces)
    ros = choose_ros(selection, environment)
    if ros is not None and ros.version != 1:
        return wanted | (_ros2(ros, environment, library) if ros.version else _without_ros(environment, wanted))
    if environment.get("ROS_VERSION") in ("0", "2") and _marked(environment) is not None:
        wanted |= hide_ros2({**environment, **wanted})
    before = _network(_marked(environment), host)
    for name, value in _network(selection, host).items():
        present = environment.get(name)
        if not present or present == before.get(name):
            wanted[name] = value
    if environment.get("ROS_IP") and not environment.get("ROS_HOSTNAME"):
        wanted.pop("ROS_HOSTNAME", None)  # it would override the address that a person has set
    return wanted


def choose_ros(selection: Selection, environment: Mapping[str, str]) -> Ros | None:
    """Return the ROS of this computer's nodes; None if none is installed."""
    try:
        return find_ros(selection.ros, environment, state_path(environment))
    except UserError:
        return None


def _ros2(ros: Ros, environment: Mapping[str, str], package: str) -> dict[str, str]:
    """Return the variables of ROS 2. Network settings of the user stay."""
    domain = choose_domain(environment, os.getuid())
    wanted = {
        "ROS_VERSION": "2",
        "ROS_DISTRO": ros.distro,
        "ROS_DOMAIN_ID": domain,
        "ROS_AUTOMATIC_DISCOVERY_RANGE": environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or "LOCALHOST",
        "UR_FACTS": facts_file(environment, domain),
    }
    if ros.distro == "humble" and wanted["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST":  # which it does not read
        wanted["ROS_LOCALHOST_ONLY"] = environment.get("ROS_LOCALHOST_ONLY") or "1"
    if ros.wheels:  # workspaces that the user has sourced come first
        given = environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
        own = [each for each in given if each and each != ros.prefix]
        wanted["AMENT_PREFIX_PATH"] = os.pathsep.join([*own, ros.prefix])
    prefixes = {**environment, **wanted}.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    own = [each for each in environment.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if each not in ("", "/usr/share")]
    folders = dict.fromkeys([package, *own, *(f"{each}/share" for each in prefixes if each)])
    wanted["ROS_PACKAGE_PATH"] = os.pathsep.join(folders)
    return wanted


def _without_ros(environment: Mapping[str, str], wanted: Mapping[str, str]) -> dict[str, str]:
    """Return the variables of nodes that share one process."""
    folders = [each for each in wanted["ROS_PACKAGE_PATH"].split(os.pathsep) if each != "/usr/share"]
    return {
        "ROS_VERSION": "0",
        "ROS_DISTRO": NONE,
        "ROS_PACKAGE_PATH": os.pathsep.join(folders),
        "UR_FACTS": facts_file(environment, NONE),
    }


def add_own_package(environment: Mapping[str, str]) -> dict[str, str]:
    """Return a copy of `environment` with this project's launch package on its path, and the workspaces of bases."""
    added = {"ROS_PACKAGE_PATH": _package_path(environment, library_path())}
    if workspaces := list_workspaces(environment):
        added["CMAKE_PREFIX_PATH"] = os.pathsep.join(workspaces)
    return {**environment, **added}


def own_packages(environment: Mapping[str, str]) -> str:
    """Return the folder of the ROS packages that `ur get` builds, whether it exists or not."""
    return f"{user_folder('XDG_DATA_HOME', environment)}/ubiquity_launches/packages"


def apply_selection(selection: Selection) -> None:
    """Set the variables of a selection for this process and its children.

    With ROS 1 they hide a ROS 2 that the shell has sourced. Raises UserError if the chosen ROS is not installed.
    """
    ros = find_ros(selection.ros, os.environ, state_path())
    if ros.version == 2 and not ros.sourced and not ros.wheels:
        os.environ.update(source_ros(ros.prefix, os.environ))
    os.environ.update(environment_changes(selection, os.environ))
    if ros.version == 1:
        os.environ.update(hide_ros2(os.environ))


def hide_ros2(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the search paths to set so that programs find the packages of ROS 1 instead of a sourced ROS 2.

    Both have Python packages of the same names (`sensor_msgs`, `std_msgs`, ...).
    """
    places = [
        os.path.normpath(place)
        for name in ("AMENT_PREFIX_PATH", "COLCON_PREFIX_PATH")
        for place in environment.get(name, "").split(os.pathsep)
        if place
    ]
    changes = {}
    for name in ("PYTHONPATH", "LD_LIBRARY_PATH", "CMAKE_PREFIX_PATH"):
        entries = environment.get(name, "").split(os.pathsep)
        kept = [entry for entry in entries if not any(_is_below(entry, place) for place in places)]
        if kept != entries:
            changes[name] = os.pathsep.join(kept)
    if environment.get("ROS_VERSION") == "0" or (places and environment.get("ROS_VERSION") == "2"):
        changes |= {"ROS_VERSION": "1", "ROS_DISTRO": "Debian"}
    return changes


def _is_below(entry: str, place: str) -> bool:
    return f"{os.path.normpath(entry)}/".startswith(f"{place}/")


def render_exports(changes: Mapping[str, str]) -> str:
    """Return `export` lines for a POSIX shell."""
    import shlex  # which Tab does without

    return "".join(f"export {name}={shlex.quote(value)}\n" for name, value in changes.items())


def _network(selection: Selection | None, hostname: str) -> dict[str, str]:
    if selection is None:
        return {}
    own = "localhost" if selection.simulated else f"{hostname}.local"
    return {"ROS_MASTER_URI": selection.master_uri, "ROS_HOSTNAME": own}


def _marked(environment: Mapping[str, str]) -> Selection | None:
    try:
        return parse_selection(environment[MARK])
    except (KeyError, UserError):
        return None


def _package_path(environment: Mapping[str, str], library: str) -> str:
    # Packages that `ur get` has built come last: those of the system or a workspace take precedence.
    found = _in_front(library, environment.get("ROS_PACKAGE_PATH", ""), "/usr/share")
    made = own_packages(environment)
    there = os.path.isdir(made)  # noqa: PTH112 - this runs at each Tab
    return _in_front(found, "", made) if there and made not in found.split(os.pathsep) else found


def _in_front(first: str, paths: str, last: str | None = None) -> str:
    rest = [path for path in paths.split(os.pathsep) if path and path != first]
    if last is not None and last not in rest:
        rest.append(last)
    return os.pathsep.join([first, *rest])
