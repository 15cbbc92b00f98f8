#!/bin/sh
# install-peers.sh FOLDER: fetches other people's engines for `make bench-peers`: wheels into a virtual environment
# FOLDER, an npm package into FOLDER/npm. With the right ones there already it takes a few milliseconds.
set -eu
[ $# -eq 1 ] || { echo "usage: install-peers.sh FOLDER" >&2; exit 2; }
wheels="$(dirname "$0")/../bench/peers/workers/requirements.txt"
jolt=jolt-physics@1.1.0
wanted="$(cat "$wheels"; echo $jolt)"
[ "$wanted" = "$(cat "$1/installed" 2>/dev/null || true)" ] && exit 0
command -v npm >/dev/null 2>&1 || { echo "install-peers.sh: npm is missing: run scripts/install-deps.sh python peers" >&2; exit 1; }

echo "installing engines to compare with into $1 (1 GB)" >&2
/usr/bin/python3 -m venv "$1"
"$1/bin/pip" install --quiet --disable-pip-version-check -r "$wheels" >&2
ln -sfn "$(echo "$1"/lib/python3*/site-packages | sed "s|^$1/||")" "$1/modules"
npm install --silent --no-audit --no-fund --prefix "$1/npm" "$jolt" >&2
echo "$wanted" >"$1/installed"
