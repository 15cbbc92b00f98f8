#!/bin/sh
# test-notebooks.sh BUILD: every notebook of examples/python is executed, by nbclient from PyPI in a virtual environment of the build folder that sees
# Debian's packages. Exit code 77, skipped, where nbclient cannot be had.
set -eu
build="$(realpath "$1")"
venv="$build/notebooks"
python="${PYTHON:-/usr/bin/python3}"
examples="$(realpath "$(dirname "$0")/../examples/python")"
if ! "$venv/bin/python" -c 'import nbclient, ipykernel' 2>/dev/null; then
  "$python" -m venv --system-site-packages "$venv" &&
    "$venv/bin/pip" install --quiet --retries 0 --timeout 30 nbclient ipykernel || {
    echo "test-notebooks.sh: skipped: nbclient cannot be installed from PyPI into $venv" >&2
    exit 77
  }
fi
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
PYTHONPATH="$build/python" MPLCONFIGDIR="$build/matplotlib" IPYTHONDIR="$folder/ipython" "$venv/bin/python" -B - "$examples"/*.ipynb <<'PROGRAM'
import sys
import nbformat
from nbclient import NotebookClient

for path in sys.argv[1:]:
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    if not any(cell.outputs for cell in cells):
        sys.exit(f"test-notebooks.sh: {path}: no cell shows anything")
    print(f"{path}: {len(cells)} cells")
PROGRAM
