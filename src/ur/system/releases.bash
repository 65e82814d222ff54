# shellcheck shell=bash disable=SC2034 # sets variables for those who source it
# Look a system up in releases.tsv. To be sourced; nothing is printed.
#
#   find_release OS_RELEASE     sets release_id, release_version, release_codename, release_ros (native, brought, refused),
#                               release_missing, release_tried (yes, no), release_name, release_note ('' where the table
#                               has -) and release_pretty (what the system calls itself). OS_RELEASE is a file such as
#                               /etc/os-release. 1 where it cannot be read (release_ros: refused).
#   read_ros_packages           prints the entries of ros_packages.txt, one a line

_releases="$(readlink -f "${BASH_SOURCE[0]}")"
_releases="${_releases%/*}"

# A subshell: the file sets variables such as NAME and VERSION.
_read_os_release() (
  unset ID ID_LIKE VERSION_ID VERSION_CODENAME UBUNTU_CODENAME DEBIAN_CODENAME PRETTY_NAME
  # shellcheck disable=SC1090 # the file in which a Linux system describes itself
  . "$1" 2>/dev/null
  printf '%s\n' "${ID-linux}" "${ID_LIKE-}" "${VERSION_ID-}" "${VERSION_CODENAME-}" "${UBUNTU_CODENAME-}" \
    "${DEBIAN_CODENAME-}" "${PRETTY_NAME-Linux}"
)

# The step of the look-up at which the row in $columns hits, 99 where it does not. Uses the variables of find_release.
_rank_release() {
  local each rank=4
  local -a family
  read -r -a family <<<"$like"
  if [[ ${columns[0]} == "$id" ]] && { [[ ${columns[1]} == "$version" ]] ||
    [[ -z $version && -n $codename && ${columns[2]} == "$codename" ]]; }; then
    echo 1
  elif [[ ${columns[0]} == "$id" && ${columns[1]} == "*" ]]; then
    echo 2
  elif [[ ${columns[2]} != - ]] && { [[ ${columns[0]} == ubuntu && ${columns[2]} == "$ubuntu" ]] ||
    [[ -z $ubuntu && ${columns[0]} == debian && ${columns[2]} == "$debian" ]] ||
    [[ -z $ubuntu$debian && " $like " == *" ${columns[0]} "* && ${columns[2]} == "$codename" ]]; }; then
    echo 3
  elif [[ ${columns[1]} == "*" ]]; then
    for each in "${family[@]}"; do
      [[ ${columns[0]} == "$each" ]] && echo $rank && return
      rank=$((rank + 1))
    done
    [[ ${columns[0]} == "*" ]] && echo 98 && return
    echo 99
  else
    echo 99
  fi
}

find_release() {
  local file="${1:?find_release OS_RELEASE}" id like version codename ubuntu debian rank best=99 line found=() columns=() status=0
  [[ -r $file ]] || status=1
  { read -r id && read -r like && read -r version && read -r codename && read -r ubuntu && read -r debian &&
    read -r release_pretty; } < <(_read_os_release "$file")
  while IFS= read -r line; do
    [[ $line == "#"* || $line == id$'\t'* ]] && continue
    IFS=$'\t' read -r -a columns <<<"$line"
    rank="$(_rank_release)"
    ((rank < best)) && best=$rank && found=("${columns[@]}")
  done <"$_releases/releases.tsv"
  ((best == 1)) || found[6]=no
  release_id="${found[0]}" release_version="${found[1]}" release_codename="${found[2]#-}" release_ros="${found[3]}"
  release_missing="${found[4]#-}" release_tried="${found[6]}" release_name="${found[7]}" release_note="${found[8]#-}"
  return $status
}

read_ros_packages() { grep -v '^#' "$_releases/ros_packages.txt"; }
