#!/bin/sh
# test-ray.sh BUILD: tests/ray_test.py with Ray from PyPI, in a virtual environment of the build folder that sees Debian's numpy. Exit code 77, skipped,
# where Ray cannot be had.
set -eu
build="$(realpath "$1")"
venv="$build/ray"
"$(dirname "$0")/test-venv.sh" "$venv" "ray" "ray>=2.9" --system-site-packages || exit $?
PYTHONPATH="$build/python" SNUG="$build/snug" exec "$venv/bin/python" -B "$(dirname "$0")/../tests/ray_test.py"
