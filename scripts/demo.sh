#!/bin/sh
# demo.sh: packs the report's five sequences as they come and writes a page for each; `make demo` builds first. Leaves files in out/.
set -eu
cd "$(dirname "$0")/.."
scenario=scenarios/box-demonstrator.yaml
mkdir -p out
for n in 1 2 3 4 5; do
  echo "sequence $n" >&2
  build/snug pack "$scenario" --sequence "$n" --program "out/sequence-$n.csv" --plan "out/sequence-$n-plan.json" -o "out/sequence-$n.h5"
  build/snug report "out/sequence-$n.h5" -o "out/sequence-$n.html"
done
echo "programs: out/sequence-N.csv, plans: out/sequence-N-plan.json, recordings: out/sequence-N.h5" >&2
echo "reports, to be opened in a browser: out/sequence-1.html ... out/sequence-5.html" >&2
