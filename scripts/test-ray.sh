#!/bin/sh
# test-ray.sh BUILD: tests/ray_test.py with Ray from PyPI, in a virtual environment of the build folder that sees Debian's numpy. Exit code 77, skipped,
# where Ray cannot be had.
set -eu
build="$(realpath "$1")"
venv="$build/ray"
python="${PYTHON:-/usr/bin/python3}"
if ! "$venv/bin/python" -c 'import ray' 2>/dev/null; then
  "$python" -m venv --system-site-packages "$venv" &&
    "$venv/bin/pip" install --quiet --retries 0 --timeout 30 'ray>=2.9' || {
    echo "test-ray.sh: skipped: Ray cannot be installed from PyPI into $venv" >&2
    exit 77
  }
fi
PYTHONPATH="$build/python" SNUG="$build/snug" exec "$venv/bin/python" -B "$(dirname "$0")/../tests/ray_test.py"
