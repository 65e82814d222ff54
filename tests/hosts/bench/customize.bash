#!/bin/bash
# Run by mmdebstrap at the end, as root on this computer: customize.bash ROOT OFFERED-LIST. Makes the root a robot that was
# just flashed: user ros, password ros; and puts the offered packages with what they need into a repository inside.
set -euo pipefail
root="$1"
mapfile -t offered < <(grep -v '^#' "$2")

rm -f "$root"/var/cache/apt/archives/*.deb
APT_CONFIG="$MMDEBSTRAP_APT_CONFIG" apt-get -q -y --no-install-recommends --download-only install "${offered[@]}"
mkdir -p "$root/srv/offered"
mv "$root"/var/cache/apt/archives/*.deb "$root/srv/offered/"
for package in "$root"/srv/offered/*.deb; do
  dpkg-deb --field "$package"
  echo "Filename: ./${package##*/}"
  echo "Size: $(stat -c %s "$package")"
  echo "SHA256: $(sha256sum "$package" | cut -d' ' -f1)"
  echo
done >"$root/srv/offered/Packages"
rm -f "$root"/etc/apt/sources.list.d/* "$root"/etc/apt/apt.conf.d/99mmdebstrap
echo 'deb [trusted=yes] file:/srv/offered ./' >"$root/etc/apt/sources.list"
rm -rf "$root"/var/lib/apt/lists/*

chroot "$root" useradd --create-home --shell /bin/bash --groups sudo,dialout,video ros
echo 'ros:ros' | chroot "$root" chpasswd
chroot "$root" useradd --create-home --shell /bin/bash --groups sudo pat
echo 'pat:pat' | chroot "$root" chpasswd

# Every computer makes its own on its first boot.
rm -f "$root"/etc/ssh/ssh_host_* "$root"/etc/resolv.conf
: >"$root/etc/machine-id"
cat >"$root/etc/systemd/system/host-keys.service" <<'EOF'
[Unit]
Description=SSH host keys
Before=ssh.service ssh.socket
[Service]
Type=oneshot
ExecStart=/usr/bin/ssh-keygen -A
[Install]
WantedBy=multi-user.target
EOF
chroot "$root" systemctl --quiet enable host-keys.service ssh.service avahi-daemon.service systemd-networkd.service
chroot "$root" systemctl --quiet mask NetworkManager.service NetworkManager-wait-online.service \
  systemd-networkd-wait-online.service apt-daily.timer apt-daily-upgrade.timer e2scrub_all.timer fstrim.timer console-getty.service
chroot "$root" systemctl --quiet set-default multi-user.target

# cloud-init is there as on an image, and sleeps: a test that wants its first boot takes the file away.
touch "$root/etc/cloud/cloud-init.disabled"

# A container may not set the clock of this computer: chrony runs, follows its sources, and only tells the difference.
mkdir -p "$root/etc/systemd/system/chrony.service.d"
printf '[Unit]\nConditionCapability=\n[Service]\nType=simple\nUser=root\nExecStart=\nExecStart=/usr/sbin/chronyd -d -x -F 0\n' >"$root/etc/systemd/system/chrony.service.d/container.conf"
