#!/bin/bash
# A Debian 13 for computers whose release has no ROS 1: debian_root.bash [status|shell|install|update|remove], or `ur setup debian`.
#
# The root file system is made once by mmdebstrap, belongs to the user, and is entered by `enter COMMAND...`: bubblewrap
# makes a mount namespace in which it is / and the computer's own folders are in their places, and nsenter replaces this
# process by the command there. So the command keeps the process id, the terminal, its process group and its parent: signals,
# job control and exit codes need no help. The process ids are those of the computer, so runs see one another.
# The root holds a copy of this file, which `.venv/bin/python` and the programs in `bin` use: it needs nothing of this project.
debian_suite=trixie
debian_data="${XDG_DATA_HOME:-$HOME/.local/share}/ubiquity_launches/debian-13"
[[ ${BASH_SOURCE[0]} == */debian-13/enter.bash ]] && debian_data="${BASH_SOURCE[0]%/*}" # the copy there: whatever HOME is now
debian_root="$debian_data/root"
debian_mark=/etc/ubiquity_debian # exists in the root only
# What a person at a terminal expects, beside what set_up.bash asks for.
debian_packages=(openssh-client rsync less procps iproute2 iputils-ping libnss-mdns libnss-myhostname tzdata)

debian_die() {
  printf 'error: %s\n' "${1//[[:cntrl:]]/?}" >&2 # a word of the command line may be the name of a file
  [[ -n ${2-} ]] && printf '  help: %s\n' "$2" >&2
  exit "${3:-2}"
}

# debian_enter COMMAND...: replace this process by the command in the root, in the same working folder.
debian_enter() {
  local user mount folder holder="" close
  if [[ -e $debian_mark ]]; then exec "$@"; fi
  [[ -e $debian_root$debian_mark ]] ||
    debian_die "the Debian root '$debian_root' does not exist" "run any command of ur, for example 'ur --version', to make it"
  folder="$(pwd -P)"
  # Processes in one user namespace may debug each other, so a later command joins the namespaces of one that still runs.
  if read -r holder 2>/dev/null <"$debian_data/namespaces" && [[ -e /proc/$holder/root$debian_mark && -d /proc/$holder/root$folder &&
    -d /proc/$holder/root$HOME ]] && { exec {user}<"/proc/$holder/ns/user" {mount}<"/proc/$holder/ns/mnt"; } 2>/dev/null; then
    :
  else
    debian_namespaces "$folder"
    printf '%s\n' "$$" >"$debian_data/namespaces.$$" && mv -f "$debian_data/namespaces.$$" "$debian_data/namespaces"
  fi
  local options=("--mount=/proc/self/fd/$mount")
  [[ $EUID -ne 0 ]] && options+=("--user=/proc/self/fd/$user" --preserve-credentials)
  # shellcheck disable=SC2016 # for the shell in the root
  printf -v close 'exec %d<&- %d<&-; cd -- "$1"; shift; exec "$@"' "$user" "$mount"
  exec nsenter "${options[@]}" -- /bin/bash -p -c "$close" ur "$folder" "$@"
}

# debian_namespaces FOLDER: make the namespaces; `user` and `mount` become descriptors of them.
debian_namespaces() {
  local arguments child
  debian_arguments "$1"
  command -v bwrap >/dev/null || debian_die "bwrap is not installed" "sudo apt-get install bubblewrap"
  coproc HOLDER { exec bwrap "${arguments[@]}" -- /bin/bash -p -c 'echo $$; read -r _'; }
  child="$HOLDER_PID"
  local from="${HOLDER[0]}" to="${HOLDER[1]}"
  read -r holder <&"$from" || debian_die "the Debian root '$debian_root' cannot be entered: bwrap failed" "$(debian_why)"
  { exec {user}<"/proc/$holder/ns/user" {mount}<"/proc/$holder/ns/mnt"; } || debian_die "the namespaces of bwrap cannot be opened"
  exec {to}>&- {from}<&- # the descriptors keep the namespaces; the process that made them ends
  wait "$child" 2>/dev/null
}

# debian_arguments FOLDER: what is where in the root, as arguments of bwrap.
debian_arguments() {
  local path
  arguments=(--ro-bind "$debian_root" / --dev-bind /dev /dev --dev-bind /proc /proc --dev-bind /sys /sys --bind /run /run
    --bind /tmp /tmp --bind-try /var/tmp /var/tmp --ro-bind /etc /host-etc --ro-bind-try /usr/lib/locale /usr/lib/locale)
  for path in /etc/passwd /etc/group /etc/ssl/certs/ca-certificates.crt; do
    [[ -e $debian_root$path ]] && arguments+=(--ro-bind-try "$path" "$path")
  done
  for path in /*; do
    case "$path" in
      /bin | /boot | /dev | /etc | /host-etc | /lib* | /lost+found | /proc | /run | /sbin | /sys | /tmp | /usr | /var) continue ;;
    esac
    [[ -d $path ]] && debian_bind "$path"
  done
  [[ -d /opt/ros ]] && arguments+=(--tmpfs /opt/ros) # what another release of ROS has put on search paths is not for this Debian
  for path in "$HOME" "$1"; do
    case "$path" in /var/* | /usr/local/*) debian_bind "$path" ;; esac
  done
}

debian_bind() {
  [[ -d $debian_root$1 ]] || mkdir -p "$debian_root$1"
  arguments+=(--bind "$1" "$1")
}

debian_why() {
  local limit=""
  read -r limit 2>/dev/null </proc/sys/kernel/apparmor_restrict_unprivileged_userns
  if [[ $limit == 1 ]]; then
    echo "AppArmor keeps users from making namespaces here; run 'ur setup debian update', which lets bwrap do it"
  else
    echo "this system may keep users from making namespaces (sysctl user.max_user_namespaces, or a container)"
  fi
}

# debian_as_root VERB ARGUMENT...: run a part of this file as root. When this process is killed, that part ends and cleans up.
debian_as_root() {
  local life status become=()
  [[ $EUID -eq 0 ]] || become=(sudo)
  exec {life}<> <(:) # a pipe of which this process alone holds the writing end
  "${become[@]}" bash "$debian_script" --as-root "$1" "$debian_data" "$(id -u)" "$(id -g)" "${@:2}" <"/dev/fd/$life" {life}>&-
  status=$?
  exec {life}>&-
  return "$status"
}

# debian_make PACKAGE...: make the root with these packages, or add to it those which it lacks.
debian_make() {
  local missing=() name hold
  mkdir -p "$debian_data" || return
  exec {hold}>"$debian_data/lock"
  flock -n "$hold" || { echo "another command is making the Debian root: waiting for it" >&2 && flock "$hold"; }
  if [[ -e $debian_root$debian_mark ]]; then
    for name in "${debian_packages[@]}" "$@"; do debian_has "$name" || missing+=("$name"); done
    [[ ${#missing[@]} -eq 0 ]] || debian_as_root install "${missing[@]}" {hold}>&- || return
  else
    debian_as_root make "${debian_packages[@]}" "$@" {hold}>&- || return
    mv -T "$debian_data/partial" "$debian_root" || return
  fi
  debian_shims
}

# Return whether the root has all of these packages.
debian_has() {
  local name
  for name; do
    [[ -e $debian_root/var/lib/dpkg/info/$name.list ]] || compgen -G "$debian_root/var/lib/dpkg/info/$name:*.list" >/dev/null || return
  done
}

# Programs of ROS, to be started from outside: `ur env` puts their folder on PATH.
debian_shims() {
  local path
  cp "$debian_script" "$debian_data/enter.bash.new" && mv "$debian_data/enter.bash.new" "$debian_data/enter.bash" || return
  rm -rf "${debian_data:?}/bin" && mkdir "$debian_data/bin" || return
  cat >"$debian_data/bin/.start" <<'END'
#!/bin/bash
# A program of the Debian root, under its own name.
data="$(readlink -f "${BASH_SOURCE[0]}")"
. "${data%/bin/.start}/enter.bash"
debian_enter "/usr/bin/${0##*/}" "$@"
END
  chmod +x "$debian_data/bin/.start"
  for path in "$debian_root"/usr/bin/{ros*,rviz*,rqt*,catkin*,tf_*,tf2_*,xacro*,urdf*,check_urdf*}; do
    [[ -x $path ]] && ln -s .start "$debian_data/bin/${path##*/}"
  done
  return 0
}

# Let bwrap make user namespaces where AppArmor allows them to named programs only (Ubuntu 24.04): with the profile of
# Ubuntu's own package, under which the programs that bwrap starts gain nothing.
debian_allow() {
  local profile=/etc/apparmor.d/bwrap-userns-restrict extra=/usr/share/apparmor/extra-profiles/bwrap-userns-restrict
  debian_allowed && return
  [[ -e $profile ]] && return 1
  [[ -e $extra ]] || apt-get -q install -y --no-install-recommends apparmor-profiles || return
  cp "$extra" "$profile" && apparmor_parser -r "$profile" && : >"$1/allowed"
}

# Packages of this computer that are needed to make the root and to enter it.
debian_lacks_tools() {
  command -v mmdebstrap >/dev/null || echo mmdebstrap
  command -v bwrap >/dev/null || echo bubblewrap
  compgen -G '/usr/share/keyrings/debian-archive-keyring.*' >/dev/null || echo debian-archive-keyring
}

debian_allowed() { bwrap --ro-bind / / true 2>/dev/null; }

debian_status() {
  [[ -e $debian_root$debian_mark ]] || { echo "no Debian root: ROS is this computer's own, or nothing was set up yet" && return; }
  echo "Debian $(<"$debian_root/etc/debian_version") in $debian_root, $(du -sm "$debian_data" 2>/dev/null | cut -f 1) MB"
}

# Processes of this user in the root.
debian_running() {
  local path
  for path in /proc/[0-9]*; do
    [[ -O $path && -e $path/root$debian_mark ]] && printf '%s\n' "${path#/proc/}"
  done
}

debian_remove() {
  local running
  [[ -e $debian_mark ]] && debian_die "the Debian root cannot be removed from inside" "run 'ur setup debian remove' in a shell of this computer"
  [[ -d $debian_data ]] || { echo "there is no Debian root in $debian_data" && return; }
  mapfile -t running < <(debian_running)
  [[ ${#running[@]} -eq 0 ]] || debian_die "programs still run in the Debian root: processes ${running[*]}" "ur stop --all, or end them"
  if [[ -e $debian_data/allowed ]]; then debian_as_root forbid || return; fi
  delete "$debian_data" 2>/dev/null || debian_as_root remove || return
  local folder
  for folder in "$1" "${debian_data%/*}"; do # that of a clone, and of a wheel
    [[ -e $folder/.venv/debian && "$(<"$folder/.venv/debian")" == "$debian_data" ]] && rm -rf "$folder/.venv"
  done
  rmdir "${debian_data%/*}" 2>/dev/null
  echo "removed $debian_data"
}

# ---- what root does: debian_root.bash --as-root VERB DATA UID GID ARGUMENT... ----

# The settings of this computer's apt that say how to reach a mirror.
apt_settings() { apt-config dump 2>/dev/null | grep -E '^Acquire::(http|https|ftp|Retries|ForceIPv|Check-|Max-ValidTime|Queue-)'; }

# The Debian mirror of this computer, where it has one; else mmdebstrap knows.
# shellcheck disable=SC2016 # fields of apt
apt_mirror() { apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' 'Label: Debian' 2>/dev/null | head -n 1; }

# guarded COMMAND...: run a command alone in its namespaces, until it ends or standard input does: then all of it is killed.
guarded() {
  local child watch status
  exec 3<&0
  unshare --mount --propagation private --pid --fork --kill-child --mount-proc bash "$debian_script" --as-root "$@" </dev/null &
  child=$!
  { read -r _ <&3; kill -KILL "$child"; } 2>/dev/null &
  watch=$!
  trap 'kill -KILL "$child" 2>/dev/null' INT TERM HUP
  wait "$child"
  status=$?
  kill "$watch" 2>/dev/null
  return "$status"
}

build() {
  local data="$1" target="$1/partial" settings="$1/partial.apt" mirror names
  shift 3
  printf -v names '%s,' "$@"
  mirror="$(apt_mirror)"
  apt_settings >"$settings"
  # Documents, translations and the static libraries of ICU are large and not used. The user gets all of it: nothing secret stays.
  # shellcheck disable=SC2016 # for the shell of the hook
  mmdebstrap --mode=root --variant=minbase --format=directory --verbose --include="${names%,}" \
    --aptopt="$settings" --aptopt='Acquire::Languages "none"' --dpkgopt=force-unsafe-io \
    --dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-exclude=/usr/share/man/*' \
    --dpkgopt='path-exclude=/usr/share/info/*' --dpkgopt='path-exclude=/usr/share/locale/*' --dpkgopt='path-exclude=/usr/lib/*/libicu*.a' \
    --setup-hook='for f in /etc/ssl/certs/ca-certificates.crt /etc/apt/auth.conf.d; do
      [ ! -e "$f" ] || { mkdir -p "$1${f%/*}" && cp -rL "$f" "$1${f%/*}/"; }; done' \
    "$debian_suite" "$target" ${mirror:+"$mirror"} || return
  rm -rf "$target"/etc/apt/auth.conf.d/* "$target"/var/lib/apt/lists/* "$target"/var/cache/apt/* "$target/etc/ssh/ssh_config.d"/*
  printf '#!/bin/sh\nexit 101\n' >"$target/usr/sbin/policy-rc.d" && chmod +x "$target/usr/sbin/policy-rc.d"
  mkdir -p "$target/host-etc" "$target/etc/xdg"
  for name in resolv.conf hosts hostname localtime timezone machine-id pip.conf xdg/pip ubiquity ssh/ssh_known_hosts; do
    rm -rf "${target:?}/etc/$name" && ln -s "/host-etc/$name" "$target/etc/$name" || return
  done
  : >"$target$debian_mark"
}

change() {
  local target="$1/root"
  shift 3
  has_folders "$target" host-etc run dev proc etc/apt/apt.conf.d etc/apt/auth.conf.d var/lib/apt/lists || return
  rm -f "$target/etc/apt/apt.conf.d/98computer"
  (set -o noclobber && apt_settings >"$target/etc/apt/apt.conf.d/98computer")
  mount --bind /etc "$target/host-etc" && mount -o remount,bind,ro "$target/host-etc" && mount --bind /run "$target/run" && mount --rbind /dev "$target/dev" &&
    mount -t proc proc "$target/proc" && mount -t tmpfs tmpfs "$target/etc/apt/auth.conf.d" || return
  cp -rL /etc/apt/auth.conf.d/. "$target/etc/apt/auth.conf.d/" 2>/dev/null
  local apt=(chroot "$target" env DEBIAN_FRONTEND=noninteractive apt-get -q -y --no-install-recommends)
  chroot "$target" dpkg --configure -a && "${apt[@]}" update && "${apt[@]}" "$@"
  local status=$?
  "${apt[@]}" clean
  (cd -P "$target/var/lib/apt/lists" && has_folders "$target" var/lib/apt/lists && rm -rf -- ./*)
  return "$status"
}

# has_folders ROOT NAME...: return whether the user, who owns the root, has put no link in the place of one of its folders: root
# writes into them.
has_folders() {
  local root name
  root="$(readlink -f -- "$1")"
  for name in "${@:2}"; do
    [[ "$(readlink -f -- "$1/$name")" == "$root/$name" ]] && continue
    echo "error: '$1/$name' is not a folder, or leads out of '$1'" >&2
    echo "  help: 'ur setup debian remove', then 'ur setup debian install', make a new one" >&2
    return 1
  done
}

# give UID GID FOLDER: give the user all of a folder. Outside the namespaces in which it was changed: what was mounted in it there,
# /etc of this computer for one, may be of the same file system, where no option of find or rm would spare it.
give() {
  local folder
  folder="$(readlink -m -- "$3")"
  is_free "$folder" && find "$folder" -xdev \( ! -uid "$1" -o ! -gid "$2" \) -exec chown --no-dereference "$1:$2" {} + && sync -f "$folder"
}

delete() {
  local folder
  folder="$(readlink -m -- "$1")"
  is_free "$folder" && rm -rf --one-file-system -- "$folder" && rm -f -- "${1%/}" # a link to it
}

# Return whether nothing is mounted in a folder, by the kernel's list, whose paths are resolved and write a blank as \040.
is_free() {
  local folder place
  folder="$(readlink -m -- "$1")"
  while read -r _ _ _ _ place _; do
    place="${place//\\040/ }" place="${place//\\011/$'\t'}" place="${place//\\012/$'\n'}" place="${place//\\134/\\}"
    [[ ${place%/}/ == "${folder%/}"/* ]] && echo "error: '$place' is mounted in '$1', which is not touched therefore" >&2 && return 1
  done </proc/self/mountinfo
  return 0
}

as_root() {
  local verb="$1" data="$2" uid="$3" gid="$4" status
  [[ $verb == build || $verb == change ]] || { exec 4<"$data" && flock 4; } # one that was interrupted may still clean up
  case "$verb" in
    make)
      delete "$data/partial" && guarded build "${@:2}" && give "$uid" "$gid" "$data/partial"
      status=$?
      rm -f "$data/partial.apt"
      [[ $status -eq 0 ]] || delete "$data/partial"
      return "$status"
      ;;
    build) shift && build "$@" ;;
    install | update)
      if [[ $verb == update ]]; then set -- "${@:1:4}" dist-upgrade; else set -- "${@:1:4}" install "${@:5}"; fi
      guarded change "${@:2}"
      status=$?
      give "$uid" "$gid" "$data/root" && return "$status"
      ;;
    change) shift && change "$@" ;;
    allow) debian_allow "$data" ;;
    forbid) rm -f /etc/apparmor.d/bwrap-userns-restrict "$data/allowed" && apparmor_parser -R /usr/share/apparmor/extra-profiles/bwrap-userns-restrict ;;
    remove) delete "$data" ;;
  esac
}

debian_script="$(readlink -f "${BASH_SOURCE[0]}")"
[[ $0 != "${BASH_SOURCE[0]}" ]] && return # read by another script
project="${debian_script%/tools/*}"
case "${1-status}" in
  --as-root) shift && as_root "$@" ;;
  status) debian_status ;;
  shell)
    shift
    [[ $# -gt 0 || ! -x $debian_root${SHELL:-/bin/bash} ]] || set -- "${SHELL:-/bin/bash}"
    [[ $# -gt 0 ]] || set -- /bin/bash
    debian_enter "$@"
    ;;
  enter) shift && debian_enter "$@" ;;
  install) shift && debian_make "$@" ;;
  update) { debian_allowed || debian_as_root allow; } && debian_as_root update && debian_shims ;;
  remove) debian_remove "$project" ;;
  *) debian_die "unknown command '$1' of 'ur setup debian'; expected status, shell, install, update or remove" ;;
esac
