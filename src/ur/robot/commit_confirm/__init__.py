"""Commit-confirm for changes that may disconnect a robot: its name, its networks.

The old files and the script that restores them are first written to the robot's disk (`guard`). Only then the robot
makes the change, independently of the connection that requested it. This computer has to connect again by the new name
or network and confirm; if it does not, because the link or this computer failed, the robot restores everything by
itself. After a power cut during the change, the robot restores everything while it boots, before its network starts. So
the robot can revert the change at any moment.

Reasons against existing tools:

- NetworkManager's checkpoints (CheckpointCreate with a rollback timeout, `nmcli device checkpoint`) live in its memory:
  a power cut or a restart forgets them, and the new profile is already on the disk. They do not cover host names, nor
  robots without NetworkManager.
- `netplan try` waits for a key on a terminal, which is lost with the link; its manual asks to verify whether a rollback
  took place, and what the disk holds before a reboot.
- `systemd-run --on-active` is a timer in /run: a power cut forgets it. It is used here for work that need not survive a
  reboot.
- `hostnamectl` sets the name in one of several places, and cannot revert it.
"""
