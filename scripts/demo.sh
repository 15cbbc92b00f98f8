#!/bin/sh
# demo.sh: packs sequence 1 of the report with a program of our own; `make demo` builds first. Leaves files in out/.
set -eu
cd "$(dirname "$0")/.."
scenario=scenarios/box-demonstrator.yaml
mkdir -p out
build/snug program "$scenario" scenarios/demo-placements.yaml --sequence 1 -o out/sequence-1.csv
build/snug simulate "$scenario" --program out/sequence-1.csv --sequence 1 -o out/sequence-1.h5
build/snug report out/sequence-1.h5 -o out/sequence-1.html
echo "program: out/sequence-1.csv, recording: out/sequence-1.h5" >&2
echo "report, to be opened in a browser: out/sequence-1.html" >&2
