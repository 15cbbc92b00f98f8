#!/bin/sh
# test-exports.sh BUILD: tests/exports_test.py, in which readers of others open what snug writes, and schemas of others check what is written for
# their programs; tests/imports_test.py, in which snug reads what their writers wrote. All of them are packages from PyPI, in a virtual environment of the
# build folder. Exit code 77, skipped, where they cannot be had.
set -eu
build="$(realpath "$1")"
venv="$build/exports"
"$(dirname "$0")/test-venv.sh" "$venv" "mcap_protobuf mcap_ros2 rosbags yaml rerun pxr pyarrow pandas xarray h5netcdf h5py check_jsonschema kubernetes_validate" \
  "mcap-protobuf-support mcap-ros2-support rosbags pyyaml rerun-sdk==0.23.1 usd-core pyarrow<20 pandas<3 xarray h5netcdf h5py check-jsonschema kubernetes-validate numpy" || exit $?
export PYTHONPATH="$build/python" SNUG="$build/snug"
"$venv/bin/python" -B "$(dirname "$0")/../tests/imports_test.py"
exec "$venv/bin/python" -B "$(dirname "$0")/../tests/exports_test.py"
