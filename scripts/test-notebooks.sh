#!/bin/sh
# test-notebooks.sh BUILD: every notebook of examples/python is executed, by nbclient from PyPI in a virtual environment of the build folder that sees
# Debian's packages. Exit code 77, skipped, where nbclient cannot be had.
set -eu
build="$(realpath "$1")"
venv="$build/notebooks"
examples="$(realpath "$(dirname "$0")/../examples/python")"
"$(dirname "$0")/test-venv.sh" "$venv" "nbclient ipykernel" "nbclient ipykernel" --system-site-packages || exit $?
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
