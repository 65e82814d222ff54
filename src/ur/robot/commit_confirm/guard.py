"""Shell scripts that revert a change on the robot, as texts. Pure.

On the robot's disk, for root alone, below `FOLDER`:

- `pending/`: the change that is being made. `id title who wait boot keeps`, `old/N` the files and folders of `keeps` as
  they were, `apply back early commit` scripts, and one file with who decides: `open`, which either the viewer renames
  to `confirmed` or the guard to `closed`. Renaming can be won by one of them only. `begun`, `applied`: how far it is.
- `last`: how the latest change ended, in three lines: its id, `confirmed` or `taken-back`, and why.
- `guard`: the script below. It runs under systemd, restarted when it is killed; and once more, while a change is
  pending, at each boot, before the network.

While the guard runs it has the lock of `ur robot setup`. Whenever it starts and finds a change that had begun before,
it takes that back. Nothing of it stays at the end.
"""

from dataclasses import dataclass

from ur.robot.setup.lock import LOCK_FILE
from ur.robot.ssh.shell import quote

FOLDER = "/var/lib/ubiquity/change"
BOOT_UNIT = "ur-change-boot.service"
UNCONFIRMED = "it was not confirmed"
BUSY, ENDED, LATE, EARLY = 71, 72, 73, 74  # exit codes of the scripts below

GUARD = f"""\
#!/bin/sh
# Takes a change of this robot's name or networks back unless it is confirmed. Written by ur; removed afterwards.
PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin; LC_ALL=C.UTF-8; export PATH LC_ALL; umask 077
d={FOLDER}; p=$d/pending; early=$1; id=; title=; wait=
say() {{ echo "$title: $*"; }}
tidy() {{
  rm -f /etc/systemd/system/multi-user.target.wants/{BOOT_UNIT} /etc/systemd/system/{BOOT_UNIT}
  rm -f "$d/guard"; [ -n "$early" ] || systemctl daemon-reload
}}
leave() {{
  exec 9>"$d/lock"; flock 9
  [ "$1" != confirmed ] || (cd "$p" && sh ./commit </dev/null 2>&1) || exit 1
  printf '%s\\n' "$id" "$1" "$2" >"$d/last.new" && mv -f "$d/last.new" "$d/last" && sync || exit 1
  rm -rf "$d/gone" && mv -T "$p" "$d/gone" && sync && rm -rf "$d/gone" || exit 1
  tidy; exit 0
}}
restore() {{
  n=0
  while IFS= read -r f; do
    n=$((n+1)); o=$p/old/$n; b=$f.ur-back
    case $early$f in boot/run/*) continue;; esac
    if [ -d "$o" ]; then rm -rf "$b"; cp -a "$o" "$b" && rm -rf "$f" && mv -T "$b" "$f" || return 1
    elif [ -e "$o" ]; then cp -a "$o" "$b" && mv -fT "$b" "$f" || return 1
    else rm -rf "$f" || return 1
    fi
  done <"$p/keeps"
  sync
}}
take_back() {{
  mv "$p/open" "$p/closed" 2>/dev/null; [ ! -e "$p/confirmed" ] || leave confirmed ''
  say "$1; going back"
  restore || {{ say "cannot restore, trying again"; exit 1; }}
  if [ -n "$early" ]; then sh "$p/early" </dev/null 2>&1; else sh "$p/back" </dev/null 2>&1; fi
  say "everything is as it was before"
  leave taken-back "$1"
}}
if [ ! -d "$p" ]; then rm -rf "$d"/new.* "$d/gone"; tidy; exit 0; fi
id=$(cat "$p/id"); title=$(cat "$p/title"); wait=$(cat "$p/wait")
this=$(cat /proc/sys/kernel/random/boot_id)
if [ -e "$p/confirmed" ]; then leave confirmed ''
elif [ "$this" != "$(cat "$p/boot")" ]; then take_back "the robot was switched off before this was confirmed"
elif [ -n "$early" ]; then exit 0
elif [ -e "$p/begun" ]; then take_back "what watches over this was killed"
fi
exec 8>>{LOCK_FILE}; flock -w 15 8 || take_back "it is being set up by $(head -n 1 {LOCK_FILE}) at the moment"
cat "$p/who" >{LOCK_FILE}
: >"$p/begun"; sync
sleep 1 # so that whoever asked learns that it begins
say "asked for by $(cat "$p/who"); begins, and goes back unless confirmed within $wait s"
sh "$p/apply" </dev/null >"$p/said" 2>&1 || {{
  why=$(sed '/^$/d' "$p/said" | tail -n 1 | cut -c 1-300); take_back "${{why:-it failed}}"
}}
: >"$p/applied"; sync
up() {{ read -r now _ </proc/uptime; now=${{now%%.*}}; }}
up; end=$((now+wait))
while [ -e "$p/open" ] && [ "$now" -lt "$end" ]; do sleep 0.2; up; done
[ ! -e "$p/confirmed" ] || {{ say "confirmed"; leave confirmed ''; }}
take_back "{UNCONFIRMED} within $wait s"
"""
UNIT = f"""\
# Written by ur while a change of name or network is pending; removed afterwards.
[Unit]
Description=Take an unconfirmed change of name or network back
DefaultDependencies=no
RequiresMountsFor={FOLDER} /etc
After=local-fs.target
Wants=network-pre.target
Before=network-pre.target NetworkManager.service systemd-networkd.service networking.service dhcpcd.service
Before=avahi-daemon.service shutdown.target
Conflicts=shutdown.target

[Service]
Type=oneshot
ExecStart=/bin/sh {FOLDER}/guard boot
Restart=on-failure
RestartSec=5
SyslogIdentifier=ur-change

[Install]
WantedBy=multi-user.target
"""
# One script, so that nothing interrupts it: it does not end with the connection.
_ARM = f"""\
trap '' HUP PIPE; set -eu; umask 077; d={FOLDER}; u=/etc/systemd/system
(umask 022; mkdir -p {FOLDER.rpartition("/")[0]}); mkdir -p -m 700 "$d"
exec 9>"$d/lock"; flock -w 20 9
if [ -d "$d/pending" ]; then cat "$d/pending/title" "$d/pending/who"; exit {BUSY}; fi
rm -rf "$d"/new.* "$d/gone"
drop() {{ rm -rf "$d"/new.* "$d/pending" "$u/multi-user.target.wants/{BOOT_UNIT}" "$u/{BOOT_UNIT}" "$d/guard"; }}
trap drop EXIT; trap 'exit 1' INT TERM
cat >"$d/guard" <<'END_OF_FILE'
@GUARD@END_OF_FILE
(umask 022; cat >"$u/{BOOT_UNIT}") <<'END_OF_FILE'
@UNIT@END_OF_FILE
mkdir -p "$u/multi-user.target.wants"; ln -sf "$u/{BOOT_UNIT}" "$u/multi-user.target.wants/{BOOT_UNIT}"
n=$(mktemp -d "$d/new.XXXXXX")
base64 -d >"$n/tar"; tar -C "$n" --no-same-owner -xf "$n/tar"; rm "$n/tar"; [ -e "$n/end" ]
cat /proc/sys/kernel/random/boot_id >"$n/boot"
mkdir "$n/old"; i=0
while IFS= read -r f; do
  i=$((i+1)); f=$(readlink -m "$f"); printf '%s\\n' "$f" >>"$n/resolved"; [ ! -e "$f" ] || cp -a "$f" "$n/old/$i"
done <"$n/keeps"
mv "$n/resolved" "$n/keeps"
systemctl daemon-reload
sync
mv -T "$n" "$d/pending"; sync
systemd-run --quiet --collect --unit=ur-change-@ID@ --description=@TITLE@ \\
  -p Restart=on-failure -p RestartSec=2 -p SyslogIdentifier=ur-change -p OOMScoreAdjust=-900 /bin/sh "$d/guard" 2>&1
trap - EXIT
"""
_SETTLE = f"""\
d={FOLDER}; p=$d/pending
if [ "$(cat "$p/id" 2>/dev/null)" != @ID@ ]; then cat "$d/last" 2>/dev/null; exit {ENDED}; fi
"""
_CONFIRM = f"""\
[ -e "$p/applied" ] || exit {EARLY}
mv "$p/open" "$p/confirmed" 2>/dev/null || exit {LATE}
sync; i=0; while [ "$(cat "$p/id" 2>/dev/null)" = @ID@ ] && [ $i -lt 100 ]; do i=$((i+1)); sleep 0.2; done
"""


@dataclass(frozen=True, slots=True)
class Ended:
    """The result of a change: confirmed, or reverted with the reason."""

    confirmed: bool
    reason: str


def arm_script(identity: str, title: str) -> str:
    """Return the script that unpacks the output of `pack_order` and arms the guard, which then starts by itself.

    Exit code BUSY: another change is pending; its title and its requester are printed. Any other nonzero exit code:
    nothing has changed.
    """
    script = _ARM.replace("@GUARD@", GUARD).replace("@UNIT@", UNIT)
    return script.replace("@ID@", quote(identity)).replace("@TITLE@", quote(title))


def pending_script() -> str:
    """Return the script that checks for a pending change of any user: exit code BUSY, as with `arm_script`."""
    return f"cd {FOLDER}/pending 2>/dev/null || exit 0; cat title who; exit {BUSY}"


def confirm_script(identity: str) -> str:
    """Return the script that confirms a change.

    Exit codes: 0 confirmed; EARLY the change is not yet complete; LATE the guard already reverts it; ENDED see
    `parse_last`.
    """
    return (_SETTLE + _CONFIRM).replace("@ID@", quote(identity))


def state_script(identity: str) -> str:
    """Return the script that reads a change's state without confirming it.

    Exit codes: EARLY the change is pending; ENDED see `parse_last`.
    """
    return _SETTLE.replace("@ID@", quote(identity)) + f"exit {EARLY}\n"


def parse_last(identity: str, output: str) -> Ended | None:
    """Parse the output of a script with exit code ENDED; None if it is about another change."""
    lines = [*output.splitlines(), "", "", ""]
    return Ended(lines[1] == "confirmed", lines[2]) if lines[0] == identity else None
