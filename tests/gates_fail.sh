#!/usr/bin/env bash
# Shows that each gate holds: a mistake is put into a copy of the last commit, and the gate must fail there, which it does
# not without the mistake. By hand; status 1 if a gate lets its mistake pass.
#   tests/gates_fail.sh [GATE...]     format, headers, clang, answers, doc_outputs, room_order; by default all of them
# The copy is made in BRINK_SCRATCH (by default a new folder, which is removed); the last three gates need its tests, which
# takes some twenty minutes of the processor to build, and none the next time where BRINK_SCRATCH is named.
set -euo pipefail
root="$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)"
scratch=${BRINK_SCRATCH:-$(mktemp -d)}
[ -n "${BRINK_SCRATCH:-}" ] || trap 'rm -rf "$scratch"' EXIT
jobs=$(nproc 2>/dev/null || echo 2)
failed=0

say() { printf '%s\n' "$*" >&2; }

undo() { git -C "$scratch" checkout -q -f HEAD && git -C "$scratch" clean -q -f -d; }

copy() {
  if [ ! -e "$scratch/.git" ]; then git clone -q --shared "$root" "$scratch"; fi
  git -C "$scratch" fetch -q "$root" HEAD
  git -C "$scratch" checkout -q -f FETCH_HEAD
  undo
}

configure() {
  [ -e "$scratch/build/release/compile_commands.json" ] ||
    cmake -S "$scratch" -B "$scratch/build/release" $(command -v ninja >/dev/null && echo -G Ninja) \
      -DCMAKE_BUILD_TYPE=Release -DBRINK_UNITY=ON -DBRINK_TESTS=ON >/dev/null
}

build() {  # TARGET...
  configure
  cmake --build "$scratch/build/release" -j "$jobs" --target "$@" >"$scratch/build/build.log" 2>&1 ||
    { tail -n 40 "$scratch/build/build.log" >&2; exit 1; }
}

test_of() { "$scratch/build/release/tests/$1" "${@:2}"; }

# The gate passes, then MISTAKE is made, and it fails.
show() {  # NAME MISTAKE GATE...
  local name=$1 mistake=$2
  shift 2
  if ! (cd "$scratch" && "$@") >"$scratch/build/gate.log" 2>&1; then
    tail -n 20 "$scratch/build/gate.log" >&2
    say "$name: fails without a mistake"
    failed=1
    return
  fi
  (cd "$scratch" && "$mistake")
  if (cd "$scratch" && "$@") >"$scratch/build/gate.log" 2>&1; then
    say "$name: LETS THE MISTAKE PASS"
    failed=1
  else
    say "$name: fails, as it must: $(grep -v '^Note' "$scratch/build/gate.log" | grep -m 1 -i -e error -e failure -e 'does not compile' || tail -n 1 "$scratch/build/gate.log")"
  fi
  undo
}

# Two blanks where the style has one.
two_blanks() { printf 'namespace brink {  int   badly_set = 0; }\n' >>core/base/log.cpp; }
show_format() { BRINK_GATE_ONLY=core/base/log show format two_blanks tests/gates.sh format; }

# A header that uses what it does not include.
without_its_include() { printf '#pragma once\n\ninline std::map<int, int> seeded;\n' >core/base/log_seeded.h; }
show_headers() {
  configure
  BRINK_GATE_ONLY=core/base/log show headers without_its_include tests/gates.sh headers
}

# A member that nobody uses, of which GCC says nothing.
unused_member() {
  printf 'namespace brink::seeded {\nclass Unused {\n  int member_ = 0;\n};\nUnused unused() { return {}; }\n}\n' >>core/base/log.cpp
}
show_clang() { BRINK_GATE_ONLY=core/base/log show clang unused_member tests/gates.sh clang; }

# One digit of one stored hash.
another_answer() { sed -i '/^break_shot,/s/,\([0-9a-f]\{15\}\)[0-9a-f],/,\1x,/' scenes/gallery/answers.csv; }
show_answers() {
  build regression_answers_test
  show answers another_answer test_of regression_answers_test --gtest_filter='*/break_shot*'
}

# The README tells of a collision more than there is.
another_count() { sed -i 's/^  collisions       \([0-9]*\)$/  collisions       1\1/' README.md; }
show_doc_outputs() {
  build brink_program contract_doc_outputs_test
  show doc_outputs another_count test_of contract_doc_outputs_test --gtest_filter='*ReadmesFirstRun'
}

# The lowest room includes one of the highest.
upward_include() { sed -i '0,/^#include/s//#include "brink\/scheduler\/policies\/policy.h"\n#include/' core/base/log.cpp; }
show_room_order() {
  build contract_room_order_test
  show room_order upward_include test_of contract_room_order_test
}

copy
mkdir -p "$scratch/build"
for gate in "${@:-format headers clang answers doc_outputs room_order}"; do
  for name in $gate; do "show_$name"; done
done
exit $failed
