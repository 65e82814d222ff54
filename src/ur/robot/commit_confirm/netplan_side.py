"""Program that changes netplan's files on a robot: on trial in /run, where a power cut loses them, or for good in /etc.

It is sent to the robot, where nothing of this project may be installed: one file that uses the standard library and
PyYAML, which netplan needs. It reads JSON from standard input: `device`, and one of `join` (`ssid`, `point`: its
settings, null for the known ones, `shown`: the name as wpa_cli prints it, in base64), `forget` (an SSID), `address` (a
definition of netplan). The environment variable TO is /etc to make permanent. With the argument `names` it prints
the wireless networks that netplan has, without their passwords, as lines of DEVICE:SSID.
"""

import copy
import json
import os
import sys
from pathlib import Path
from typing import Any

import yaml

Tree = dict[str, Any]
OURS = "90-ur.yaml"
MARK = "# Written by ur robot.\n"
TRIAL = "# Written by ur robot, on trial.\n"
# netplan knows no order of preference, and wpa_supplicant would choose the strongest.
PREFER = """\
# Written by ur robot wifi: prefers the network that was joined last.
[Service]
ExecStartPost=
ExecStartPost=-/bin/sh -c 'w="wpa_cli -i {device}"; i=0; \\
  until $$w ping >/dev/null 2>&1 || [ $$i -ge 50 ]; do i=$$((i+1)); sleep 0.1; done; \\
  for n in $$($$w list_networks | cut -f 1 | grep -x "[0-9]*"); do \\
  s=$$($$w get_network $$n ssid); [ "$$(printf %%s "$$s" | base64 -w 0)" != {shown} ] || \\
  $$w set_network $$n priority 10; done; $$w reassociate'
"""


def load(root: Path, *, trial: bool) -> Tree:
    """Load netplan's files by name; one shadows that of the same name in an earlier folder (netplan(5)).

    All scalars are strings, as they are for netplan. Without `trial`, files on trial are left out.
    """
    found = {}
    for folder in ("lib", "etc", "run"):
        for path in (root / folder / "netplan").glob("*.yaml"):
            text = path.read_text()
            if trial or not text.startswith(TRIAL):
                found[path.name] = yaml.load(text, Loader=yaml.BaseLoader) or {}  # noqa: S506 - makes strings only
    return dict(sorted(found.items()))


def section(content: object, *names: str) -> Tree:
    """Return a mapping inside a file, empty if it is missing."""
    for name in ("network", *names):
        content = content.get(name) if isinstance(content, dict) else None
    return content if isinstance(content, dict) else {}


def names(files: Tree) -> dict[str, list[str]]:
    """Return the wireless networks of each device."""
    found: dict[str, list[str]] = {}
    for content in files.values():
        for device in section(content, "wifis"):
            known = found.setdefault(device, [])
            known += [ssid for ssid in section(content, "wifis", device, "access-points") if ssid not in known]
    return found


def change(files: Tree, order: Tree) -> None:
    """Apply an order to the files."""
    device = order["device"]
    mine = files.setdefault(OURS, {}).setdefault("network", {"version": "2"})
    if "address" in order:
        # A definition of its own, whose file networkd prefers by its name: lists of others would be merged with ours.
        mine.setdefault("ethernets", {})[f"00-ur-{device}"] = {"match": {"name": device}, **order["address"]}
    if order.get("point") is not None:
        new = {} if device in names(files) else {"dhcp4": "true", "optional": "true"}
        own = mine.setdefault("wifis", {}).setdefault(device, new)
        own.setdefault("access-points", {})[order["ssid"]] = order["point"]
    if "forget" in order:
        for content in files.values():
            points = section(content, "wifis", device, "access-points")
            if points.pop(order["forget"], None) is not None and not points:
                del content["network"]["wifis"][device]["access-points"]
        if not names(files).get(device):  # netplan refuses a wireless device without networks
            for content in files.values():
                if section(content, "wifis").pop(device, None) is not None and not section(content, "wifis"):
                    del content["network"]["wifis"]


def run(root: Path, order: Tree, to: str) -> None:
    """Write the changed files below /run or /etc of `root`; in /etc, those on trial are removed afterwards."""
    trial = to == "/run"
    before = load(root, trial=False)
    after = copy.deepcopy(before)
    change(after, order)
    folder = root / to.lstrip("/")
    for name, content in after.items():
        if content != before.get(name):
            text = yaml.safe_dump(content, default_style='"', sort_keys=False, width=1000)
            write(folder / "netplan" / name, (TRIAL if trial else MARK) + text, 0o600)
    prefer = "systemd/system/netplan-wpa-{}.service.d/{}"
    if "ssid" in order:
        name = prefer.format(order["device"], "91-ur-trial.conf" if trial else "90-ur.conf")
        write(folder / name, PREFER.format(device=order["device"], shown=order["shown"]), 0o644)
    if not trial:
        os.sync()
        (root / "run" / prefer.format(order["device"], "91-ur-trial.conf")).unlink(missing_ok=True)
        for path in (root / "run/netplan").glob("*.yaml"):
            if path.read_text().startswith(TRIAL):
                path.unlink()


def write(path: Path, text: str, mode: int) -> None:
    """Write a file atomically."""
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_name(path.name + ".new")
    new.unlink(missing_ok=True)
    with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "w") as stream:
        stream.write(text)
        stream.flush()
        os.fsync(stream.fileno())
    new.chmod(mode)
    new.replace(path)


if __name__ == "__main__":
    if sys.argv[1:] == ["names"]:
        for device, ssids in names(load(Path("/"), trial=True)).items():
            sys.stdout.writelines(f"{device}:{ssid}\n" for ssid in ssids)
    else:
        run(Path("/"), json.load(sys.stdin), os.environ.get("TO", "/run"))
