"""Changes of a robot that may cost the way to it: its name, its networks. The robot itself holds the way back.

The old files and what restores them are put on the robot's disk first (`guard`). Only then the change is made there,
apart from the connection that asked for it. This computer has to come back over the new name or network and confirm;
where it does not, because the link or this computer failed, the robot restores everything by itself. After a power cut
in the middle it does so while it boots, before its network starts. There is never a moment without a way back.

Why not what is there already:

- NetworkManager's checkpoints (CheckpointCreate with a rollback timeout, `nmcli device checkpoint`) live in its memory:
  a power cut or a restart forgets them, and the new profile is already on the disk. They know nothing of host names
  and of robots without NetworkManager.
- `netplan try` waits for a key on a terminal, which ends with the link; its manual asks to verify whether a rollback
  took place, and what the disk holds before a reboot.
- `systemd-run --on-active` is a timer in /run: a power cut forgets it. It serves here for what need not outlive a boot.
- `hostnamectl` sets one of the places that hold a name, and nothing takes it back.
"""
