#!/bin/bash
# Look the locked Python packages up in a database of known vulnerabilities: audit_locks.bash [OPTION OF PIP-AUDIT ...]
#
# All lock files in requirements/ are audited with pip-audit, which is installed in .cache/audit from requirements/audit.lock,
# by its hashes. Nothing of the other locks is installed. Without options the database is that of the Python Package Index; `-s osv` asks
# OSV, and `-s osv --osv-url URL` a mirror of it. Exit code 1: vulnerabilities; 2: some packages could not be audited.
set -u
cd "$(dirname "$(readlink -f "$0")")/.." || exit 2
audit=.cache/audit/bin/pip-audit
if [[ ! -x $audit || requirements/audit.lock -nt $audit ]]; then
  install=(.cache/audit/bin/python -m pip install -q --disable-pip-version-check --require-hashes --no-deps -r requirements/audit.lock)
  if ! python3 -m venv --clear .cache/audit || ! "${install[@]}"; then
    rm -rf .cache/audit
    echo "error: pip-audit could not be installed in .cache/audit" >&2
    echo "help: check the network and pip's settings (pip config list), then run this again" >&2
    exit 2
  fi
fi
printed="$(mktemp)" || exit 2
trap 'rm -f "$printed"' EXIT

worst=0
for lock in requirements/*.lock; do
  "$audit" --disable-pip --require-hashes --progress-spinner off --strict -r "$lock" "$@" >"$printed" 2>&1
  code=$?
  if [[ $code -eq 0 ]]; then
    echo "$lock: no known vulnerabilities"
  elif grep -q '^Found [0-9]* known vulnerabilit' "$printed"; then
    echo "$lock: $(grep '^Found' "$printed")"
    grep -v '^Found' "$printed"
    [[ $worst -eq 2 ]] || worst=1
  else
    echo "error: $lock could not be audited: $(grep -v '^ *$' "$printed" | tail -n 1)" >&2
    worst=2
  fi
done
if [[ $worst -eq 2 ]]; then
  echo "help: this needs the Python Package Index, or with '-s osv' the OSV database, or with '-s osv --osv-url URL' a mirror of it" >&2
fi
exit $worst
