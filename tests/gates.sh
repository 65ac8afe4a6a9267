#!/usr/bin/env bash
# Gates beside the tests, on a laptop as in CI, after `./brink test`:
#   tests/gates.sh [GATE...]     format, headers, clang, sanitizers; by default all of them
# Each prints one line; the first that fails ends it with what was wrong and status 1.
#   format      every source is as clang-format writes it
#   headers     every header compiles by itself: those that a source of their name includes first do so there, by clang
#   clang       no source gives clang a warning
#   sanitizers  mutated scenes and run files, random worlds and flights, under address and undefined sanitizers
# BRINK_GATE_ONLY=TEXT looks at files with this in their names alone (format, headers, clang).
# tests/gates_fail.sh shows each of them, and some tests, fail on a mistake.
# A gate whose tool is not installed (clang-format, clang) and cannot be installed is left out, and says so.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
jobs=$(nproc 2>/dev/null || echo 2)
folders="core integrators scheduler scenes tests"

say() { printf '%s\n' "$*" >&2; }

has() {  # COMMAND PACKAGE: installs it if it can
  command -v "$1" >/dev/null && return 0
  if [ -z "${BRINK_NO_INSTALL:-}" ] && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$2" >/dev/null 2>&1 || true
  fi
  command -v "$1" >/dev/null
}

sources() { find $folders -name '*.h' -o -name '*.cpp' | grep -F -e "${BRINK_GATE_ONLY:-}" | sort; }

gate_format() {
  if ! has clang-format clang-format; then say "gate format: left out, there is no clang-format"; return; fi
  sources | xargs clang-format --dry-run --Werror
}

# The flags with which the build compiles, from its own list; without its precompiled headers.
flags_of() {  # FILE (a part of its name)
  python3 - "$1" <<'PY'
import json, shlex, sys
for entry in json.load(open('build/release/compile_commands.json')):
    if sys.argv[1] in entry['file']:
        words, flags, skip = shlex.split(entry['command']), [], False
        for word, following in zip(words, words[1:] + ['']):
            if skip:
                skip = False
            elif word in ('-o', '-c', '-include'):
                skip = True
            elif word in ('-I', '-isystem'):
                flags += [word, following]
                skip = True
            elif word.startswith(('-I', '-D', '-std')):
                flags.append(word)
        print(' '.join(shlex.quote(f) for f in flags))
        break
PY
}

# Headers to be compiled by themselves: those of tests as the tests are, which clang need not compile. Those that a source
# of their name includes first are not among them where clang compiles that source.
single_headers() {  # COMPILER
  sources | grep '\.h$' | while read -r header; do
    source=${header%.h}.cpp
    if [ "$1" = clang++ ] && [ "${header%%/*}" != tests ] && [ -e "$source" ] &&
      grep -m 1 '^#include' "$source" | grep -qF "brink/$header"; then continue; fi
    echo "$header"
  done
}

gate_headers() {
  has python3 python3 || { say "gate headers: needs python3"; return 1; }
  local compiler=c++ flags
  if has clang++ clang; then compiler=clang++; fi
  # shellcheck disable=SC2046
  flags="$(flags_of scenes/program) $(pkg-config --cflags cairo 2>/dev/null) -I. -DBRINK_SOURCE_DIR='\"\"' -DBRINK_BINARY_DIR='\"\"'"
  single_headers $compiler | sed '/^tests/!s:^:brink/:' |
    xargs -P "$jobs" -I{} sh -c "case {} in tests/*) compiler=c++ ;; *) compiler=$compiler ;; esac
      printf '#include \"%s\"\n' {} | \$compiler -x c++ - $flags -fsyntax-only || { echo '{}: does not compile by itself' >&2; exit 255; }"
}

gate_clang() {
  has python3 python3 || { say "gate clang: needs python3"; return 1; }
  if ! has clang++ clang; then
    say "gate clang: left out, there is no clang++"
    return
  fi
  cmake -S . -B build/clang -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++ -DBRINK_WERROR=ON \
    -DBRINK_TESTS=OFF -DBRINK_PRECOMPILE=OFF >build/clang.log 2>&1
  python3 - <<'PY' | xargs -P "$jobs" -I{} sh -c '{}'
import json, os, shlex
for entry in json.load(open('build/clang/compile_commands.json')):
    if os.environ.get('BRINK_GATE_ONLY', '') not in entry['file']:
        continue
    command = entry['command'].replace(' -fsyntax-only', '')
    words = [w for w in shlex.split(command) if 'ccache' not in w]
    at = words.index('-o')
    words[at:at + 2] = ['-fsyntax-only']
    print(shlex.quote('cd ' + shlex.quote(entry['directory']) + ' && ' + shlex.join(words) + ' || exit 255'))
PY
}

gate_sanitizers() {
  local build=build/sanitize
  cmake -S . -B "$build" $(command -v ninja >/dev/null && echo -G Ninja) -DCMAKE_BUILD_TYPE=None \
    -DCMAKE_CXX_FLAGS="-O1 -g1" -DBRINK_UNITY=ON -DBRINK_SANITIZE=ON -DBRINK_TESTS=ON >build/sanitize.log 2>&1
  cmake --build "$build" -j "$jobs" --target brink_program fuzz_scene_mutation_test fuzz_run_file_mutation_test \
    fuzz_random_worlds_test fuzz_first_contact_test >>build/sanitize.log 2>&1 || { tail -n 40 build/sanitize.log >&2; return 1; }
  export UBSAN_OPTIONS=print_stacktrace=1 LSAN_OPTIONS=suppressions=$PWD/tests/leaks.supp:print_suppressions=0
  {
    BRINK_FUZZ_COUNT=${BRINK_FUZZ_COUNT:-300} BRINK_FUZZ_SECONDS=60 "$build/tests/fuzz_scene_mutation_test" &&
      BRINK_FUZZ_COUNT=${BRINK_FUZZ_COUNT:-100} BRINK_FUZZ_SECONDS=60 "$build/tests/fuzz_run_file_mutation_test" &&
      BRINK_WORLDS=10 "$build/tests/fuzz_random_worlds_test" &&
      BRINK_FLIGHTS=500 "$build/tests/fuzz_first_contact_test"
  } >build/sanitize_runs.log 2>&1 || { tail -n 60 build/sanitize_runs.log >&2; return 1; }
}

mkdir -p build
for gate in "${@:-format headers clang sanitizers}"; do
  for name in $gate; do
    begin=$(date +%s)
    "gate_$name" || { say "gate $name: failed"; exit 1; }
    say "gate $name: passed ($(($(date +%s) - begin)) s)"
  done
done
