#!/bin/sh
# install-viewer.sh [--background]: fetches the npm packages that viewer/ is built and tested with, as viewer/package-lock.json
# lists them.
#
# With the right ones there already it takes a few milliseconds. Needs node 18 or newer and npm (scripts/install-deps.sh).
# --background returns at once; who reads the packages waits for them by locking package-lock.json (scripts/build-viewer.sh).
set -eu
cd "$(dirname "$0")/../viewer"
stamp=node_modules/.snug-installed
is_right() { cmp -s package-lock.json "$stamp"; }
is_right && exit 0
command -v npm >/dev/null 2>&1 || { echo "install-viewer.sh: npm is missing: run scripts/install-deps.sh" >&2; exit 1; }

install() {
  is_right && return 0 # by another, while this one waited
  echo "installing the npm packages of viewer/" >&2
  # npm ci refuses a lock file that lacks optional packages of other platforms, which not every registry offers; npm install
  # takes the locked versions too and changes nothing of ours with --no-save.
  npm ci --silent --no-audit --no-fund >/dev/null 2>&1 || npm install --no-save --silent --no-audit --no-fund >&2
  cp package-lock.json "$stamp"
}

exec 9<package-lock.json
flock 9
if [ "${1:-}" = --background ]; then
  install </dev/null &
else
  install
fi
