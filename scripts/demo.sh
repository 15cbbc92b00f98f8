#!/bin/sh
# demo.sh: packs the report's five sequences as they come and writes a page for each; `make demo` builds first. Leaves files in out/.
#
# The page of the first is written at once and named; those of the others are written while the next sequence is packed.
set -eu
cd "$(dirname "$0")/.."
snug="${SNUG:-build/snug}"
scenario=scenarios/box-demonstrator.yaml
mkdir -p out

write_page() { # of sequence $1
  "$snug" report "out/sequence-$1.h5" -o "out/sequence-$1.html"
  [ ! -t 2 ] || printf '\r\033[K' >&2 # the line that says how far the packing of the next one is
  echo "sequence $1: open out/sequence-$1.html in a browser" >&2
}

page=""
for n in 1 2 3 4 5; do
  echo "sequence $n of 5" >&2
  "$snug" pack "$scenario" --sequence "$n" --program "out/sequence-$n.csv" --plan "out/sequence-$n-plan.json" -o "out/sequence-$n.h5"
  [ -z "$page" ] || wait "$page"
  if [ "$n" -eq 1 ]; then
    write_page 1
  else
    write_page "$n" &
    page=$!
  fi
done
wait "$page"
echo "programs: out/sequence-N.csv, plans: out/sequence-N-plan.json, recordings: out/sequence-N.h5" >&2
