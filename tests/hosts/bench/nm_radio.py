#!/usr/bin/python3
"""Stand-in for the radio of a robot with a real NetworkManager: no kernel of a container has a wireless device.

Installed before nmcli, and run as a service with `serve`. `wlan0` is a veth, which NetworkManager itself knows as a
cable with the profiles LINKS; nmcli shows it as a wireless device that uses a wireless profile of the real
NetworkManager. Networks in the air, and the other end of the veth, are those of radio.py.
"""

import fcntl
import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

AIR, STATE, LOCK = Path("/etc/bench-air.json"), Path("/run/bench-radio.json"), Path("/run/bench-radio.lock")
LINKS = {"infrastructure": "11111111-07ad-4d0f-a8f1-6ad8cd0e3c11", "ap": "22222222-07ad-4d0f-a8f1-6ad8cd0e3c11"}
T = TypeVar("T")
FIELDS = "802-11-wireless.ssid,802-11-wireless.mode,802-11-wireless-security.psk,connection.autoconnect-priority"


def real(*words: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(["/usr/bin/nmcli", *words], capture_output=True, text=True, check=False)


def ip(*words: str) -> None:
    subprocess.run(["ip", "link", "set", "air", *words], check=False)


def used() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(STATE.read_text()) if STATE.exists() else {}
    return found


def read(uuid: str) -> dict[str, Any]:
    done = real("-s", "-e", "no", "-g", FIELDS, "connection", "show", uuid)
    ssid, mode, psk, priority = [*done.stdout.split("\n"), "", "", ""][:4]
    return {"uuid": uuid, "ssid": ssid, "mode": mode or "infrastructure", "psk": psk, "priority": int(priority or 0)}


def leave() -> None:
    STATE.unlink(missing_ok=True)
    ip("down")
    for link in LINKS.values():
        real("connection", "down", link)


def join(profile: dict[str, Any], wait: str) -> str:
    """Use a profile; return why that fails."""
    leave()
    if profile["mode"] != "ap":
        password, reached, _ = json.loads(AIR.read_text()).get(profile["ssid"], [None, False, 0])
        if password is None:
            return "Error: Connection activation failed: The Wi-Fi network could not be found."
        if password != profile["psk"]:
            return "Error: Connection activation failed: (7) Secrets were required, but not provided."
        ip(*(["master", "ether"] if reached else ["nomaster"]), "up")
    else:
        ip("master", "ether", "up")
    if real("--wait", wait, "connection", "up", LINKS[profile["mode"]], "ifname", "wlan0").returncode:
        leave()
        return "Error: Connection activation failed: IP configuration could not be reserved."
    STATE.write_text(json.dumps(profile))
    return ""


def keep_joined() -> None:
    """Do what NetworkManager does by itself: leave what is out of reach, join the best known network."""
    air, now = json.loads(AIR.read_text()), used()
    here = now.get("mode") == "ap" or now.get("ssid") in air
    if now and here and real("-g", "GENERAL.STATE", "device", "show", "wlan0").stdout.startswith("100"):
        return
    if now:
        leave()
    rows = real("-t", "-f", "UUID,TYPE", "connection", "show").stdout.splitlines()
    known = [read(row.split(":")[0]) for row in rows if row.endswith(":802-11-wireless")]
    good = [each for each in known if each["mode"] != "ap" and air.get(each["ssid"], [None])[0] == each["psk"]]
    if good:
        join(max(good, key=lambda each: (each["priority"], air[each["ssid"]][2])), "10")


def locked(action: Callable[[], T]) -> T:
    with LOCK.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        return action()


def shown(line: str, fields: list[str]) -> str:
    """Return a line of the devices, with wlan0 as a wireless one."""
    row, now = line.split(":"), used()
    values = {"DEVICE": "wlan0", "TYPE": "wifi", "STATE": "connected" if now else "disconnected"}
    values["CON-UUID"] = now.get("uuid", "")
    return ":".join(values[field] for field in fields) if row[0] == "wlan0" else line


def main(words: list[str]) -> int:
    line = " ".join(words)
    if words == ["serve"]:
        while True:
            locked(keep_joined)
            time.sleep(1)
    if "device wifi list" in line:
        for ssid, (password, _, strength) in json.loads(AIR.read_text()).items():
            mark = "*" if used().get("ssid") == ssid else " "
            row = (mark, str(2 * (strength + 100)), "2437 MHz", "WPA2" if password else "", ssid)
            sys.stdout.write(":".join(row) + "\n")
        return 0
    if "connection up uuid" in line and words[-1] == "wlan0":
        wait = words[words.index("--wait") + 1]
        problem = locked(lambda: join(read(words[words.index("uuid") + 1]), wait))
        sys.stderr.write(f"{problem}\n" if problem else "")
        return 4 if problem else 0
    done = real(*words)
    sys.stderr.write(done.stderr)
    out = done.stdout
    if "device status" in line:
        fields = words[words.index("-f") + 1].split(",")
        out = "".join(f"{shown(each, fields)}\n" for each in out.splitlines())
    if "connection delete" in line or "connection reload" in line:
        locked(lambda: leave() if used() and real("connection", "show", used()["uuid"]).returncode else None)
    sys.stdout.write(out)
    return done.returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
