#!/bin/sh
# test-gymnasium.sh BUILD: python/tests/test_gymnasium.py with Gymnasium from PyPI, in a virtual environment of the build folder that sees Debian's numpy
# and pytest. Exit code 77, skipped, where Gymnasium cannot be had.
set -eu
build="$(realpath "$1")"
venv="$build/gymnasium"
"$(dirname "$0")/test-venv.sh" "$venv" "gymnasium" "gymnasium>=1.1 numpy" --system-site-packages || exit $?
cd "$(dirname "$0")/../python/tests"
PYTHONPATH="$build/python" exec "$venv/bin/python" -B -m pytest -q -p no:cacheprovider test_gymnasium.py
