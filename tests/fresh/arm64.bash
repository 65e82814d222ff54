# shellcheck shell=bash
# An emulated arm64 computer for tests/fresh/run, which sources this: a Debian 13, qemu-user, and a binfmt_misc of a user
# namespace of its own, so that the programs of this computer run as before. It needs Linux 6.7 or later.
#
# Its packages are unpacked and their scripts are not run, which under emulation would take longer than all that is tried:
# no package of ROS is installed, and it calls itself Ubuntu 24.04, whose nodes run in one process on arm64.
# shellcheck disable=SC2034,SC2154 # variables of tests/fresh/run
kept="${XDG_CACHE_HOME:-/var/cache}/ur-arm64"
arm64_packages=(base-files base-passwd bash coreutils dash diffutils findutils grep hostname libc-bin libgomp1 libstdc++6 mawk
  procps python3 python3-venv sed util-linux)
sample_packages="click markdown-it-py mdurl msgspec numpy packaging platformdirs pygments pyyaml rich rich-click typing-extensions"
test_packages="hypothesis iniconfig pluggy psutil pytest pytest-asyncio pytest-timeout sortedcontainers"
processor=cortex-a72 # of a Raspberry Pi 4; the wider vectors of qemu's own one give numpy wrong products of matrices
arm64_tests=(tests/ur_nodes/{geometry,slam,navigation,drivers} tests/launchfile)
arm64_left_out=( # tests that cannot pass under emulation, and why
  tests/ur_nodes/drivers/test_guard.py # motors must stop within a real time
)

# emulate COMMAND...: replace this process by the command as root of a user namespace in which arm64 programs run.
emulate() {
  local outside
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

# unpack_arm64 FOLDER: a Debian 13 of arm64 in `root`, and in `native` one that runs here, with the same Python and with
# qemu-aarch64: that of Debian 12 is too old.
unpack_arm64() {
  local names="${arm64_packages[*]}" each folder arch more
  for each in "native amd64 ,qemu-user" "root arm64"; do
    read -r folder arch more <<<"$each"
    mmdebstrap --quiet --mode=root --skip=chroot/mount/sys "${apt_settings[@]/#/--aptopt=}" --architectures="$arch" \
      --variant=extract --include="${names// /,}$more" trixie "$1/$folder" - <"$fresh/sources" || return
  done
  mv "$1/native/usr/bin/qemu-aarch64" "$1/native/usr/bin/arm64" && rm "$1"/native/usr/bin/qemu-* || return
  # What the packages' scripts would have done:
  for each in passwd group; do cp "$1/root/usr/share/base-passwd/$each.master" "$1/root/etc/$each"; done
  ln -s mawk "$1/root/usr/bin/awk"
  compile_python "$1/native" "$1/root" /mnt/usr/lib/python3.13
  echo 'pat:x:1000:1000::/home/pat:/bin/bash' >>"$1/root/etc/passwd" && echo 'pat:x:1000:' >>"$1/root/etc/group"
  mkdir -p "$1/root/home/pat" "$1/root/etc/apt/preferences.d"
}

# compile_python NATIVE ROOT FOLDER...: compile Python files of the emulated computer on this one, which is much faster.
compile_python() {
  mkdir -p "$1/mnt" && mount --bind "$2" "$1/mnt" || return
  chroot "$1" python3 -m compileall -q -s /mnt -p / "${@:3}" >/dev/null
  umount "$1/mnt"
}

# find_arm64: the folder of the unpacked computer, made now where the cache has none.
find_arm64() {
  local key unfinished
  key="$( (declare -f unpack_arm64 compile_python && echo "${arm64_packages[@]}") | sha256sum | cut -c 1-12)"
  mkdir -p "$kept" && exec 8>"$kept/lock" && flock 8 || return
  if [[ ! -d $kept/$key ]]; then
    rm -rf --one-file-system "${kept:?}"/*/
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

# install_locked FOLDER FOLDER...: install the entries of $fresh/lock in the first, and compile the Python files of all.
install_locked() {
  "$root/.venv/bin/python" -m pip install --quiet --disable-pip-version-check --target "$target$1" --require-hashes \
    --only-binary :all: --platform manylinux_2_28_aarch64 --platform manylinux_2_17_aarch64 --python-version 3.13 \
    --no-deps --no-compile -r "$fresh/lock" 2>/dev/null || { status=1 && echo "== failed: pip install"; }
  compile_python "$unpacked/native" "$target" "${@/#//mnt}"
  chown -R 1000:1000 "$target/home/pat"
}

# try_arm64: the parts.
try_arm64() {
  local begin=$SECONDS packages=/home/pat/packages python=.venv/bin/python
  limit=3600 # .ci/run leaves it what its tests do not need
  if runs sample; then
    step "arm64: tests of geometry and ur check, without the set-up"
    # shellcheck disable=SC2086 # words
    { locked run $sample_packages && locked dev $test_packages; } >"$fresh/lock"
    install_locked "$packages" "/home/pat/$folder/src"
    expect "tests" 0 " passed" "env PYTHONPATH=$packages:src python3 -m pytest -p no:cacheprovider --timeout 1200 tests/ur_nodes/geometry"
    expect "ur check" 0 "found in [0-9]* files" "env PYTHONPATH=$packages:src python3 -m ur check ubiquity_launches"
    echo "== sample: $((SECONDS - begin)) s"
  fi
  limit=1800
  runs drive || runs check || runs page || runs test || return
  step "the set-up, by a user who may not use sudo"
  pretend_ubuntu
  expect "set-up" 0 "no ROS: all nodes" "./ur use sim --ros none"
  echo "== set up in $((SECONDS - begin)) s"
  if runs drive; then
    begin=$SECONDS
    step "the first README command, told to drive to a goal and quit"
    expect "drive" 0 "g 0.5 0 0: reached" "bash -c \"printf 'g 0.5 0 0\nq\n' | ./ur run keyboard_navigate\""
    echo "== driven in $((SECONDS - begin)) s"
  fi
  if runs check; then
    step "ur check"
    expect "ur check" 0 "found in [0-9]* files" "./ur check ubiquity_launches"
  fi
  if runs page; then
    begin=$SECONDS
    step "the page"
    expect "page" 0 "frames of the page" "$python tests/fresh/page.py 8393 900"
    echo "== page: $((SECONDS - begin)) s"
  fi
  if runs test; then
    begin=$SECONDS
    step "tests"
    # shellcheck disable=SC2086 # words
    { locked dev $test_packages && locked vision gtsam; } >"$fresh/lock"
    install_locked "/home/pat/$folder/.venv/lib/python3.13/site-packages" "/home/pat/$folder/tests"
    run_tests "$python -m pytest -n 3 --timeout 1200 -m 'not ros and not slow and not hosts and not nightly' ${arm64_left_out[*]/#/--ignore=} ${arm64_tests[*]}"
    echo "== tests: $((SECONDS - begin)) s"
  fi
}
