#!/bin/sh
# build-viewer.sh FOLDER: builds the viewer's page into FOLDER; waits for scripts/install-viewer.sh while that is at work.
set -eu
cd "$(dirname "$0")/../viewer"
exec 9<package-lock.json
flock -s 9
if ! cmp -s package-lock.json node_modules/.snug-installed; then
  echo "build-viewer.sh: the npm packages of viewer/ are missing or others than package-lock.json lists: run \`make setup\`," \
    "or configure with -DSNUG_VIEWER=OFF for a program without reports" >&2
  exit 1
fi
SNUG_VIEWER_OUT="$1" npm run --silent build
