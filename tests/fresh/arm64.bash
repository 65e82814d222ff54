# shellcheck shell=bash
# An emulated arm64 computer for tests/fresh/run, which sources this: a Debian 13, qemu-user, and a binfmt_misc of a user
# namespace of its own, so that the programs of this computer run as before. It needs Linux 6.7 or later.
#
# Its packages are unpacked and their scripts are not run, which under emulation would take longer than all that is tried:
# no package of ROS is installed, and it calls itself Ubuntu 24.04, whose nodes run in one process on arm64.
# shellcheck disable=SC2154 # root, target, fresh and folder are those of tests/fresh/run
kept="${XDG_CACHE_HOME:-/var/cache}/ur-arm64"
arm64_packages=(base-files base-passwd bash coreutils dash diffutils findutils gawk grep hostname libc-bin libstdc++6 libgomp1
  procps python3 python3-venv sed util-linux)
sample_packages="click markdown-it-py mdurl msgspec numpy packaging platformdirs pygments pyyaml rich rich-click typing-extensions"
test_packages="hypothesis iniconfig pluggy psutil pytest pytest-asyncio pytest-timeout sortedcontainers"

# emulate COMMAND...: replace this process by the command as root of a user namespace in which arm64 programs run.
emulate() {
  local code outside
  outside="$(readlink /proc/self/ns/user)"
  { # the namespace's users can be written from outside only
    until [[ "$(readlink "/proc/$$/ns/user")" != "$outside" ]]; do sleep 0.05; done
    echo "0 0 65536" >"/proc/$$/uid_map" && echo "0 0 65536" >"/proc/$$/gid_map"
  } &
  # shellcheck disable=SC2016 # expanded by the inner shell
  exec unshare --user bash -c 'until read -r _ </proc/self/uid_map; do sleep 0.05; done; exec "$@"' emulate \
    unshare --mount --pid --fork --kill-child --mount-proc "$@"
}

# let_arm64_run QEMU: make the kernel run arm64 programs by it, in this user namespace.
let_arm64_run() {
  local zeros='\x00\x00\x00\x00\x00\x00\x00\x00' ones='\xff\xff\xff\xff\xff\xff\xff'
  printf '%s' ":ur-arm64:M::\x7fELF\x02\x01\x01$zeros\x00\x02\x00\xb7\x00:$ones\x00$ones\xff\xfe\xff\xff\xff:$1:POCF" \
    >"$fresh/binfmt/register"
}

# unpack_arm64 FOLDER: a Debian 13 of arm64, and qemu-aarch64 of the same release beside it: Debian 12's is too old.
unpack_arm64() {
  local names="${arm64_packages[*]}"
  mmdebstrap --quiet --mode=root "${apt_settings[@]/#/--aptopt=}" --architectures=arm64,amd64 --variant=extract \
    --include="${names// /,},qemu-user:amd64" trixie "$1/root" - <"$fresh/sources" || return
  mv "$1/root/usr/bin/qemu-aarch64" "$1/" && rm "$1"/root/usr/bin/qemu-* || return
  for name in passwd group; do cp "$1/root/usr/share/base-passwd/$name.master" "$1/root/etc/$name"; done
  echo 'pat:x:1000:1000::/home/pat:/bin/bash' >>"$1/root/etc/passwd" && echo 'pat:x:1000:' >>"$1/root/etc/group"
  mkdir "$1/root/home/pat"
  # Without the packages' scripts Python's files are not compiled: pat, who runs them first, may do so.
  chown -R 1000:1000 "$1/root/home/pat" "$1"/root/usr/lib/python3*
}

# find_arm64: the folder of the unpacked computer, made now where the cache has none.
find_arm64() {
  local key unfinished
  key="$( (declare -f unpack_arm64 && echo "${arm64_packages[@]}") | sha256sum | cut -c 1-12)"
  mkdir -p "$kept" && exec 8>"$kept/lock" && flock 8 || return
  if [[ ! -d $kept/$key ]]; then
    rm -rf --one-file-system "$kept"/*/
    unfinished="$(mktemp -d "$kept/unfinished.XXXXXX")" && unpack_arm64 "$unfinished" && mv -T "$unfinished" "$kept/$key" || return
  fi
  exec 8>&-
  printf '%s\n' "$kept/$key"
}

# locked FILE NAME...: the entries of a lock of requirements/ that have these names, in a file of the emulated computer.
locked() {
  local wanted="${*:2}"
  awk -v "names=${wanted// /|}" '/^[a-z].*==/ { split($1, name, "=="); on = name[1] ~ "^(" names ")$" } on' "$root/requirements/$1.lock"
}

# try_arm64: the parts.
try_arm64() {
  local begin=$SECONDS packages=/home/pat/packages python=.venv/bin/python
  if runs sample; then
    step "arm64: tests of geometry and ur check, without the set-up"
    # shellcheck disable=SC2086 # words
    { locked run $sample_packages && locked dev $test_packages; } >"$fresh/lock"
    "$root/.venv/bin/python" -m pip install --quiet --disable-pip-version-check --target "$target$packages" --require-hashes \
      --only-binary :all: --platform manylinux_2_28_aarch64 --platform manylinux_2_17_aarch64 --python-version 3.13 \
      --no-deps --no-compile -r "$fresh/lock" 2>/dev/null || { status=1 && echo "== failed: pip install"; }
    chown -R 1000:1000 "$target$packages"
    expect "tests" 0 " passed" "env PYTHONPATH=$packages:src python3 -m pytest -p no:cacheprovider tests/ur_nodes/geometry"
    expect "ur check" 0 "found in [0-9]* files" "env PYTHONPATH=$packages:src python3 -m ur check ubiquity_launches"
    echo "== sample: $((SECONDS - begin)) s"
  fi
}
