#!/bin/sh
# test-urdf.sh BUILD FOLDER: python/tests/test_urdf.py: each URDF file of a folder against Pinocchio, which comes from PyPI into a virtual environment of
# the build folder. Exit code 77, skipped, without a folder (or with SNUG_URDF_FOLDER unset) and where Pinocchio cannot be had.
set -eu
build="$(realpath "$1")"
folder="${2:-${SNUG_URDF_FOLDER:-}}"
python="${PYTHON:-/usr/bin/python3}"
if [ -z "$folder" ] || [ ! -d "$folder" ]; then
  echo "test-urdf.sh: skipped: no folder of URDF files${folder:+ at $folder} (SNUG_URDF_FOLDER)" >&2
  exit 77
fi
folder="$(realpath "$folder")"
venv="$build/pinocchio"
"$(dirname "$0")/test-venv.sh" "$venv" "pinocchio" "pin" || exit $?
cd "$(dirname "$0")/../python/tests"
SNUG_URDF_FOLDER="$folder" SNUG_PINOCCHIO="$venv/bin/python" PYTHONPATH="$build/python" \
  exec "$python" -B -m pytest -q -s -p no:cacheprovider test_urdf.py
