#!/usr/bin/env bash
# Installs a build of Brink into a fresh folder, and builds and runs the consumer project against what is there.
#   tests/consumer/run.sh BUILD_DIR
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >/dev/null
cmake -S "$here" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix"
cmake --build "$work/build"
"$work/build/consumer"
"$work/build/readme_example"
"$work/build/own_policy"
"$work/prefix/bin/brink" --version
"$work/prefix/bin/brink" list scenes | grep -q .
