#!/bin/bash
# Set this computer up: set_up.bash run|test|ros1|ros2 [FOLDER]. Debian packages, a virtual environment, the locked Python
# packages. `ros1` and `ros2` are `run` with that version of ROS, whatever this release has.
#
# Every step looks first and does only what is missing, so it may be interrupted anywhere and started again. The stamp
# .venv/ready-PROFILE is written last and names this folder, since a virtual environment does not survive being moved;
# the second line of ready-run is the digest of the files that the environment was made from. An installed wheel, whose
# folder may belong to root, has `.venv` and `.cache` in FOLDER; there the stamp names the environment of the wheel.
set -uo pipefail
umask o-w # nothing is writable for everybody, whatever the shell has set
profile="${1:?set_up.bash run|test|ros1|ros2 [FOLDER]}"
wanted_ros=
[[ $profile == ros[12] ]] && wanted_ros="${profile#ros}" profile=run
root="$(readlink -f "${BASH_SOURCE[0]}")"
root="${root%/tools/*}"
wheel="${root%/lib/python*/site-packages/ur/_project}" # the environment of a wheel
source="${root%/ur/_project}" # of the Python packages
[[ $wheel == "$root" ]] && wheel="" source="$root/src"
state="${2:-$root}"
if [[ ! -d $state ]] && ! mkdir -p "$state"; then exit 2; fi
cd "$state" || exit 2
log="$state/.cache/set_up.log"
python=/usr/bin/python3

# shellcheck source=src/ur/system/releases.bash
. "$source/ur/system/releases.bash" || exit 2

# A name with | is the first of the alternatives that this release has.
mapfile -t packages < <(read_ros_packages)
packages=(python3 python3-venv ca-certificates "${packages[@]}")
# EGL and Mesa render the simulated camera without a screen; the programs of the first drive have none.
[[ $profile == test ]] && packages+=(git openssh-client shellcheck tmux zsh fish xvfb liburdfdom-tools libegl1 libopengl0 libgl1-mesa-dri)
# Images of systems are made and read back with the tools of others.
[[ $profile == test ]] && packages+=(mtools dosfstools fdisk e2fsprogs openssl)
# What a command opens and starts is compared with what it may.
[[ $profile == test ]] && packages+=(strace)
# The page of ur web is tried in Chromium. Ubuntu has it as a snap only, which tests cannot drive: they are left out.
browser_packages=("chromium-headless-shell|chromium" fonts-dejavu-core)
command -v npm >/dev/null || browser_packages+=(npm) # the tools of these tests are packages of npm
[[ $profile == test ]] && grep -qx 'ID=debian' /etc/os-release && packages+=("${browser_packages[@]}")

say() { printf '%s\n' "$*" >&2; }

die() {
  say "error: $1"
  [[ -n ${2-} ]] && say "  help: $2"
  exit 2
}

check_system() {
  local arch expected="expected Debian 12 or later, or Ubuntu 22.04 or later, on x86-64 or arm64"
  arch="$(uname -m)"
  find_release /etc/os-release
  case "$release_ros:$arch" in
    native:x86_64 | native:aarch64 | brought:x86_64 | brought:aarch64) ;;
    *) die "$release_pretty on $arch is not supported${release_note:+ ($release_note)}; $expected" ;;
  esac
  [[ $release_tried == yes ]] || say "note: $release_pretty is expected to work, but was not tried"
}

# run_step TITLE COMMAND...: output goes to the log; a terminal shows the time and how far it is, or the last line. For
# pip, $asked is the number of packages. Nothing that it starts holds the lock, and a program that needs no root gets a
# process group of its own, so that it can be ended with all that it has started.
asked=0
run_step() {
  local title="$1" start=$SECONDS from width line status apart=()
  shift
  printf '\n== %s: %s\n' "$title" "$*" >>"$log"
  from=$(wc -c <"$log")
  if [[ $(type -t "$1") == file && ! " $* " =~ \ (apt-get|dpkg)\  ]]; then apart=(setsid) group=-; fi
  "${apart[@]}" "$@" >>"$log" 2>&1 </dev/null 9>&- &
  child=$!
  if [[ -t 2 ]]; then
    while [[ -e /proc/$child ]]; do
      width=$(($(tput cols 2>/dev/null || echo 80) - 1))
      line="$(tail -c "+$((from + 1))" "$log" | awk -v count="$asked" -f "$source/ur/system/progress.awk" | tr -cd '[:print:]')"
      printf '\r\033[K%.*s' "$width" "  $title, $((SECONDS - start)) s: $line" >&2
      sleep 0.3
    done
    printf '\r\033[K' >&2
  else
    say "  $title ..."
  fi
  wait "$child"
  status=$?
  child='' group=''
  if [[ $status -ne 0 ]]; then
    line="$(tail -c "+$((from + 1))" "$log" | grep -oEm 1 "Temporary failure [^<>()]*|Name or service not known|Network is unreachable")"
    if [[ -n $line ]]; then
      say "error: $title: no network: $line (details in $log)"
    else
      say "error: $title failed (exit code $status); the last lines of $log:"
      tail -c "+$((from + 1))" "$log" | grep -vE '^ *$|^(dl|pm)status:' | tail -n 12 | sed 's/^/  | /' >&2
    fi
    return "$status"
  fi
  say "  $title: done in $((SECONDS - start)) s"
}

is_installed() { [[ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]; }

missing_packages() {
  local entry name
  for entry in "${packages[@]}"; do
    for name in ${entry//|/ }; do is_installed "$name" && continue 2; done
    printf '%s\n' "$entry"
  done
}

# The first of the alternatives that apt knows, else the first.
choose_name() {
  local name
  for name in ${1//|/ }; do
    [[ -n "$(apt-cache policy "$name" 2>/dev/null)" ]] && printf '%s\n' "$name" && return
  done
  printf '%s\n' "${1%%|*}"
}

become_root=()
ask_for_root() {
  [[ $EUID -eq 0 ]] && return
  command -v sudo >/dev/null || die "Debian packages are missing and sudo is not installed: ${missing[*]}" \
    "as root, run: apt-get install ${missing[*]%%|*}"
  say "  this needs root: sudo may ask for your password"
  if ! sudo -n true 2>/dev/null; then
    [[ -t 0 ]] || die "sudo wants a password and there is no terminal to ask on" \
      "run this in a terminal, or install as root: apt-get install ${missing[*]%%|*}"
    sudo -v || die "sudo was refused" "ask an administrator to run: apt-get install ${missing[*]%%|*}"
  fi
  become_root=(sudo)
}

apt_get() {
  run_step "$1" "${become_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 -o APT::Status-Fd=1 "${@:2}"
}

install_packages() {
  local names=() entry
  mapfile -t missing < <(missing_packages)
  [[ ${#missing[@]} -eq 0 ]] && return
  say "  ${#missing[@]} Debian packages are missing: ${missing[*]%%|*}"
  ask_for_root
  # An interrupted installation leaves packages half-configured or a journal behind; apt refuses everything until then.
  if [[ -n "$(dpkg --audit 2>/dev/null)" ]] || compgen -G "/var/lib/dpkg/updates/[0-9]*" >/dev/null; then
    run_step "mending an interrupted installation" "${become_root[@]}" env DEBIAN_FRONTEND=noninteractive dpkg --configure -a
  fi
  apt_get "package lists" update ||
    die "the package lists could not be fetched" "check the network and the sources in /etc/apt, then run this again"
  # A package that was killed while it was unpacked keeps itself and all that need it from being configured.
  mapfile -t broken < <(dpkg-query -W -f='${db:Status-Eflag} ${binary:Package}\n' 2>/dev/null | sed -n 's/^reinstreq //p')
  [[ ${#broken[@]} -eq 0 ]] || apt_get "unpacking again what was interrupted" install -y --reinstall "${broken[@]}"
  for entry in "${missing[@]}"; do names+=("$(choose_name "$entry")"); done
  # The files that were fetched are deleted when they are installed: 130 MB.
  apt_get "${#names[@]} Debian packages and what they need" -o APT::Keep-Downloaded-Packages=false \
    install -y --no-install-recommends "${names[@]}" ||
    die "Debian packages could not be installed" \
      "see above; the package lists of $release_name have all of them, so check the sources in /etc/apt (on Ubuntu the component 'universe' must be enabled: sudo add-apt-repository universe); then run this again"
}

# RViz is large, and useless without a screen; a computer that gets one later gets RViz then.
offer_rviz() {
  [[ -n "${DISPLAY-}${WAYLAND_DISPLAY-}" ]] || return 0
  is_installed rviz && return
  if [[ ,$release_missing, == *,rviz,* ]]; then
    say "  $release_name does not package RViz: the terminal and the page show the map"
    return
  fi
  missing=(rviz)
  say "  there is a display and no RViz: installing it"
  ask_for_root
  apt_get "RViz" install -y --no-install-recommends rviz ||
    say "warning: RViz could not be installed; everything else works without it"
}

# Make the Debian root if need be, and set up this folder in there.
bring_debian() {
  local wanted=("${packages[@]%%|*}")
  # shellcheck source=tools/debian_root.bash
  . "$root/tools/debian_root.bash"
  log="$PWD/.cache/debian_root.log"
  : >"$log"
  [[ -n "${DISPLAY-}${WAYLAND_DISPLAY-}" ]] && wanted+=(rviz)
  [[ $profile == test ]] && wanted+=("${browser_packages[@]%%|*}")
  mapfile -t packages < <(debian_lacks_tools)
  install_packages
  if ! debian_allowed; then
    missing=(apparmor-profiles) && ask_for_root
    debian_as_root allow >>"$log" 2>&1
    debian_allowed || die "the program 'bwrap' may not make user namespaces on this computer" "$(debian_why)"
  fi
  if [[ ! -e $debian_root$debian_mark ]] || ! debian_has "${debian_packages[@]}" "${wanted[@]}"; then
    say "this release has no ROS 1: it runs in a Debian 13 in $debian_data (ur setup debian remove deletes it)"
    missing=(mmdebstrap) && ask_for_root
    run_step "Debian 13 with ROS" debian_make "${wanted[@]}" ||
      die "the Debian 13 for ROS could not be made" "check the network and the free space (df -h '$debian_data'), then run this again"
  elif ! cmp -s "$root/tools/debian_root.bash" "$debian_data/enter.bash"; then
    debian_shims
  fi
  debian_enter bash "$root/tools/set_up.bash" "$@"
}

has_wheels() { [[ $(uname -m) == x86_64 ]]; }

# The user's own ROS 2, the newest in /opt/ros; '' where there is none.
find_own_ros2() {
  local folder own=
  for folder in /opt/ros/*/share/rclpy; do
    folder="${folder%/share/rclpy}"
    [[ -r $folder/setup.bash && (${folder##*/} > j || $folder == */humble) ]] && own="$folder"
  done
  printf '%s' "$own"
}

# Do without ROS 1, unless the user has asked for it, where this release has none, or only ROS 2 is installed: Humble.
leave_ros1() {
  [[ $profile == run && $wanted_ros != 1 && ! -e .venv/debian ]] || return
  own_ros2="$(find_own_ros2)"
  [[ $release_ros == brought || ( -n $own_ros2 && ! -e /usr/bin/rosmaster ) ]]
}

# pip for a virtual environment where the release keeps it in a package of its own: without root, where apt can fetch it.
bring_pip() {
  local folder="$PWD/.cache/pip-package" wheels
  rm -rf "$folder" && mkdir -p "$folder" || return
  (cd "$folder" && apt-get -q download python3-pip-whl && dpkg-deb -x python3-pip-whl_*.deb .) || return
  wheels=("$folder"/usr/share/python-wheels/pip-*.whl)
  PYTHONPATH="${wheels[0]}" exec .venv/bin/python -m pip install --no-index --disable-pip-version-check "${wheels[0]}"
}

make_environment() {
  local wanted found
  wanted="$($python -c 'import sys; print(sys.version_info[:2])')"
  found="$(.venv/bin/python -c 'import sys; print(sys.version_info[:2])' 2>/dev/null)"
  if [[ $wanted != "$found" ]] || ! .venv/bin/python -m pip --version >/dev/null 2>&1; then
    if "$python" -c 'import ensurepip' 2>/dev/null; then
      run_step "virtual environment" "$python" -m venv --clear --system-site-packages .venv ||
        die "the virtual environment .venv could not be made" "look at $log, then run this again"
    else
      if ! "$python" -m venv --clear --without-pip --system-site-packages .venv || ! run_step "pip" bring_pip; then
        die "the virtual environment .venv could not be made" "sudo apt-get install python3-venv; then run this again"
      fi
      rm -rf .cache/pip-package
    fi
  fi
  [[ -e /etc/ubiquity_debian ]] && enter_by_python
}

# In the Debian root: .venv/bin/python enters it, so that whatever starts it may do so from outside.
enter_by_python() {
  local version link again="$root/ur --version"
  [[ -n $wheel ]] && again="ur use"
  version="$($python -c 'import sys; print("python%d.%d" % sys.version_info[:2])')"
  for link in python3 "$version"; do ln -sfn "/usr/bin/$version" ".venv/bin/$link"; done
  rm .venv/bin/python
  cat >.venv/bin/python <<END
#!/bin/bash
# Python of this environment, which is one of a Debian root: see tools/debian_root.bash.
program="\${BASH_SOURCE[0]%/*}/$version"
[[ -e /etc/ubiquity_debian ]] && exec "\$program" "\$@"
read -r data <"\${BASH_SOURCE[0]%/*}/../debian"
if [[ ! -r \$data/enter.bash ]]; then
  echo "error: the Debian root '\$data' does not exist" >&2
  echo "  help: make it again: $again" >&2
  exit 2
fi
. "\$data/enter.bash"
debian_enter "\$program" "\$@"
END
  chmod +x .venv/bin/python
  printf '%s\n' "${XDG_DATA_HOME:-$HOME/.local/share}/ubiquity_launches/debian-13" >.venv/debian
}

# The packages of a ROS 2 are compiled for the numpy of its release: before 2 up to Jazzy.
choose_lock() {
  local major
  major="$("$python" -c 'import numpy; print(numpy.__version__.split(".")[0])' 2>/dev/null)"
  if [[ -n $own_ros2 && $major == 1 ]]; then
    printf '%s\n' "$root/requirements/run.numpy1.lock"
  else
    printf '%s\n' "$root/requirements/run.lock"
  fi
}

install_python() {
  local locks name kept=()
  locks=(-r "$(choose_lock)")
  if [[ $profile == test ]]; then # 260 MB, 20 s
    for name in dev vision robot web foxglove three lsp recordings mcp; do locks+=(-r "$root/requirements/$name.lock"); done
  fi
  # What was fetched before an interruption is kept until the end; a user of pip has a cache of his own.
  [[ -d ${XDG_CACHE_HOME:-${HOME-}/.cache}/pip ]] || kept=(--cache-dir "$PWD/.cache/pip")
  for name in "${locks[@]}"; do [[ $name == -r ]] || asked=$((asked + $(grep -c '^[^ #].*==' "$name"))); done
  # PYTHONPATH of a shell that sourced another ROS would make pip think that its packages are ours.
  run_step "Python packages" env -u PYTHONPATH .venv/bin/python -m pip install --progress-bar off --no-compile \
    --disable-pip-version-check --require-hashes --only-binary :all: "${kept[@]}" "${locks[@]}" ||
    die "the Python packages could not be installed" "check the network and pip's settings (pip config list), then run this again"
  asked=0
  rm -rf .cache/pip
  # On all processors, where pip would use one, but for tests. What is not compiled here is when it is used first.
  run_step "compiling the Python packages" .venv/bin/python -I -m compileall -q -j 0 -x /tests/ .venv/lib/python3.*/site-packages
  if [[ -n $wheel ]]; then
    run_step "this project" copy_wheel || die "the project could not be copied into $state/.venv" "look at $log, then run this again"
    return
  fi
  run_step "this project" env -u PYTHONPATH .venv/bin/python -m pip install --disable-pip-version-check \
    --no-deps --no-build-isolation --no-index --editable "$root" ||
    die "the project could not be installed into .venv" "look at $log, then run this again"
}

# The tools of the tests of the page, where npm is: Ubuntu, whose tests have no browser, gets none.
install_page_tools() {
  local folder=.cache/npm/page
  if ! command -v npm >/dev/null || cmp -s "$root/requirements/npm/package-lock.json" $folder/ready; then return; fi
  rm -rf $folder
  mkdir -p $folder && cp "$root"/requirements/npm/*.json $folder || return
  run_step "npm packages" npm ci --prefix $folder --ignore-scripts --no-audit --no-fund ||
    die "the npm packages could not be installed" "check the network and npm's settings (npm config list), then run this again"
  cp $folder/package-lock.json $folder/ready
}

# ROS 2 as wheels, in an environment of its own: one of its packages starts every Python of it a second time. What else
# nodes need comes from .venv; of the system nothing, where the messages of ROS 1 have the same names.
install_ros2() {
  has_wheels || return 0
  local lock="$root/requirements/ros2.lock" packages made_for kept=()
  packages="$(echo "$PWD"/.venv/lib/python3.*/site-packages)"
  made_for="$(cat "$lock" && "$python" --version && echo "$packages")"
  [[ "$(cat .ros2/ready 2>/dev/null)" == "$made_for" ]] && return
  rm -rf .ros2
  asked=$(grep -c '^[^ #].*==' "$lock")
  "$python" -m venv --without-pip .ros2 || die "the virtual environment .ros2 could not be made" "look at $log, then run this again"
  [[ -d ${XDG_CACHE_HOME:-${HOME-}/.cache}/pip ]] || kept=(--cache-dir "$PWD/.cache/pip")
  # With pip of .venv, which leaves out what is there already.
  run_step "$ros2_wheels" env PYTHONPATH="$packages" .ros2/bin/python -m pip install --progress-bar off --no-compile \
    --disable-pip-version-check --require-hashes --only-binary :all: --no-deps "${kept[@]}" -r "$lock" ||
    die "ROS 2 could not be installed" "check the network and pip's settings (pip config list), then run this again"
  asked=0
  rm -rf .cache/pip
  echo "import site; site.addsitedir('$packages')" >"$(echo .ros2/lib/python3.*/site-packages)/zz_nodes.pth"
  printf '%s:' "$PWD/.ros2/lib" "$PWD"/.ros2/lib/python3.*/site-packages/ros_*.libs | sed 's/:$/\n/' >.ros2/libraries
  run_step "compiling ROS 2" .venv/bin/python -I -m compileall -q -j 0 .ros2/lib/python3.*/site-packages
  printf '%s\n' "$made_for" >.ros2/ready
}

# A copy of what the wheel holds: programs that run go on when pipx or uv replaces the wheel.
copy_wheel() {
  local to
  to="$(.venv/bin/python -I -c 'import sysconfig; print(sysconfig.get_path("purelib"))')" || return
  rm -rf "$to"/ur "$to"/ur_nodes "$to"/ubiquity_launches-*.dist-info
  cp -R "$source"/ur "$source"/ur_nodes "$source"/ubiquity_launches-*.dist-info "$to" || return
  find "$to"/ur "$to"/ur_nodes -name __pycache__ -prune -exec rm -rf {} +
  exec .venv/bin/python -I -m compileall -q -x /_project/ "$to"/ur "$to"/ur_nodes # there, programs ending in .py are bash
}

# apt that is terminated takes the terminal away from dpkg, which dies of that and leaves the package in its hands broken;
# after an interrupt, it ends when dpkg is done.
dpkg_works() {
  local name
  for file in /proc/[0-9]*/comm; do
    read -r name <"$file" && [[ $name == dpkg ]] && return 0 # in a trap, return alone means the status before it
  done 2>/dev/null
  return 1
}

child='' group='' # `group` is '-' where kill ends the process group of `child`
interrupted() {
  local signal said=
  trap '' INT TERM HUP
  child="${child:-$(jobs -pr)}"
  while [[ -n $child && -e /proc/$child ]]; do
    signal=TERM
    if [[ -z $group ]] && dpkg_works; then
      signal=INT
      [[ -n $said ]] || say "  ending when the packages in hand are unpacked ..."
      said=yes
    fi
    kill -s "$signal" -- "$group$child" 2>/dev/null || [[ -n $group ]] || sudo -n kill -s "$signal" "$child" 2>/dev/null
    sleep 0.2
  done
  [[ -n $child ]] && wait "$child"
  [[ -z $group ]] || kill -s KILL -- "-$child" 2>/dev/null # what has outlived its leader
  say ""
  say "interrupted: nothing is broken, the next start continues"
  exit 130
}
trap interrupted INT TERM HUP

check_system
[[ $wanted_ros != 2 || -n $(find_own_ros2) ]] || has_wheels || die "there is no ROS 2 as Python packages for $(uname -m)" \
  "install ROS 2 Humble, Jazzy or later in /opt/ros, or simulate without ROS: ur use sim --ros none"
mkdir -p .cache 2>/dev/null
if [[ ! -w . || ! -w .cache || ( -e .venv && ! -w .venv ) ]]; then
  help="git clone it into your home folder"
  [[ -n $wheel ]] && help="list the permissions of all folders above it: namei -l $state/.venv"
  die "$state is not writable for $(id -un), expected a folder of your own" "$help"
fi
own_ros2='' ros2_wheels="ROS 2 Kilted as Python packages, supported until December 2026"
if leave_ros1; then
  packages=()
  [[ -x $python ]] || die "$python does not exist" "install Python 3 with the packages of $release_name, then run this again"
elif [[ $release_ros == brought ]]; then
  bring_debian "$@"
fi
exec 9>>.cache/set_up.lock
if ! flock -n 9; then
  read -r holder <.cache/set_up.lock
  say "another set-up of this folder is running, process ${holder:-of unknown number}: waiting for it"
  flock 9
fi
echo $$ >.cache/set_up.lock
begin=$SECONDS
made_from="$(cd "$root" && cat requirements/run.lock tools/set_up.bash "$source/ur/system/ros_packages.txt" pyproject.toml | sha256sum)"
made_from="${made_from%% *}" # before it is used: a file that changes meanwhile makes the next start look again
: >"$log"
say "setting up this computer ($profile); details in $log"
if [[ ${#packages[@]} -eq 0 ]]; then
  nodes="nodes run with ${own_ros2:+ROS 2 in }${own_ros2:-$ros2_wheels}"
  [[ -n $own_ros2 ]] || has_wheels || nodes="and there is no ROS 2 as Python packages for $(uname -m): all nodes run in one process"
  say "there is no ROS 1: $nodes ('ur use sim --ros 1' brings ROS 1)"
else
  install_packages
  offer_rviz
fi
make_environment
install_python
[[ $profile == test ]] && install_page_tools
if [[ $profile == test || $wanted_ros == 2 || -e .ros2 || ( ${#packages[@]} -eq 0 && -z $own_ros2 ) ]]; then install_ros2; fi
rm -f .venv/block-signal
/usr/bin/env --block-signal=INT true 2>/dev/null && : >.venv/block-signal # coreutils 8.31 and later; see `ur`
printf '%s\n%s\n' "${wheel:-$root}" "$made_from" >.venv/ready-run
[[ $profile == test ]] && printf '%s\n' "$root" >.venv/ready-test
say "set up in $((SECONDS - begin)) s"
