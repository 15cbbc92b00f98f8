#!/bin/sh
# test-gymnasium.sh BUILD: python/tests/test_gymnasium.py with Gymnasium from PyPI, in a virtual environment of the build folder that sees Debian's numpy
# and pytest. Exit code 77, skipped, where Gymnasium cannot be had.
set -eu
build="$(realpath "$1")"
venv="$build/gymnasium"
python="${PYTHON:-/usr/bin/python3}"
if ! "$venv/bin/python" -c 'import gymnasium' 2>/dev/null; then
  "$python" -m venv --system-site-packages "$venv" &&
    "$venv/bin/pip" install --quiet --retries 0 --timeout 20 'gymnasium>=1.1' 'numpy<2' || {
    echo "test-gymnasium.sh: skipped: Gymnasium cannot be installed from PyPI into $venv" >&2
    exit 77
  }
fi
cd "$(dirname "$0")/../python/tests"
PYTHONPATH="$build/python" exec "$venv/bin/python" -B -m pytest -q -p no:cacheprovider test_gymnasium.py
