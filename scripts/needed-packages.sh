#!/bin/sh
# needed-packages.sh PROGRAM: the Debian packages whose libraries a program loads, one a line.
set -eu
[ $# -eq 1 ] && [ -f "$1" ] || { echo "needed-packages.sh: expected one program" >&2; exit 2; }
ldd "$1" | sed -n 's/.*=> \(\/[^ ]*\) .*/\1/p' | while read -r library; do
  # A library is packaged where it stands, or where /lib was before /lib and /usr/lib became one.
  for path in "$(readlink -f "$library")" "$library" "${library#/usr}" "/usr$library"; do
    owner="$(dpkg-query --search "$path" 2>/dev/null | sed -n 's/:.*//p' | head -n 1)"
    [ -z "$owner" ] || { echo "$owner"; break; }
  done
done | sort -u
