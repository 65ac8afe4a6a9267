#!/usr/bin/env bash
# The same bits from every build: compiles regression_answers_test by each BUILD, runs all scenes of the gallery, and
# compares the hashes of their last states.
#   tests/same_bits.sh [BUILD...]        gcc-O3 gcc-O2 clang-O3 clang-O2 gcc-native aarch64-O3 aarch64-O2
#   tests/same_bits.sh sysroot FOLDER    unpacks the arm64 packages that aarch64 needs into FOLDER (Debian; apt's own
#                                        state is left as it is)
# By default all but gcc-native (-march=native). A build whose compiler is not installed is left out, and says so; so is
# aarch64 without g++-aarch64-linux-gnu, qemu-user-static, and BRINK_AARCH64_SYSROOT=FOLDER. Builds are kept in
# build/same_bits; BRINK_JOBS says how many sources are compiled at a time.
# Prints a table, "=" for the hash of the first build. Status 1: hashes differ where no solver has a part in it. Scenes
# that need SUNDIALS are told apart ("solver"): it is compiled elsewhere and uses the C library's powers.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
jobs=${BRINK_JOBS:-$(nproc 2>/dev/null || echo 2)}
folder=build/same_bits

say() { printf '%s\n' "$*" >&2; }

# Packages unpacked, none installed, by an apt that knows nothing of this machine's.
make_sysroot() {  # FOLDER
  local root packages=(libc6 libc6-dev linux-libc-dev libcrypt1 libcrypt-dev libgcc-s1 libgcc-12-dev libgomp1 libatomic1
    libstdc++6 libstdc++-12-dev
    libsundials-dev libsundials-arkode5 libsundials-cvode6 libsundials-nvecserial6 libsundials-nvecparallel-openmp6
    libsundials-nvecparallel-pthread6 libsundials-sunmatrix4 libsundials-sunlinsol3 libklu1 libamd2 libcolamd2 libbtf1
    libsuitesparseconfig5 libblas3 liblapack3 libgfortran5
    libfmt-dev libfmt9 libspdlog-dev libspdlog1.10 libmuparser-dev libmuparser2v5 libsqlitecpp-dev libsqlite3-dev
    libsqlite3-0 zlib1g-dev zlib1g libgtest-dev libgmock-dev googletest libbenchmark-dev libbenchmark1debian
    libboost1.74-dev nlohmann-json3-dev libeigen3-dev libcli11-dev libtomlplusplus-dev libtomlplusplus3
    libcpp-httplib-dev libcpp-httplib0.11 libssl3 libssl-dev libbrotli1 libbrotli-dev
    libcairo2 libcairo2-dev libpixman-1-0 libfontconfig1 libfreetype6 libpng16-16 libxcb-shm0 libxcb1 libxcb-render0
    libxrender1 libx11-6 libxext6 libxau6 libxdmcp6 libbsd0 libmd0 libexpat1 libuuid1
    libosmesa6 libosmesa6-dev libgl-dev libegl-dev libgl1 libglvnd0 libegl1 libglapi-mesa libglx-dev libllvm15 libz3-4
    libedit2 libtinfo6 libicu72 libxml2 liblzma5 libzstd1 libdrm2 libsensors5 libelf1 libffi8 mesa-common-dev libx11-dev)
  mkdir -p "$1"
  root=$(readlink -f "$1")
  mkdir -p "$root"/apt/{state/lists/partial,cache/archives/partial,packages} "$root/pkgconfig"
  : >"$root/apt/status"
  cat >"$root/apt/apt.conf" <<CONF
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
APT::Sandbox::User "$(id -un)";
Dir::State "$root/apt/state";
Dir::State::status "$root/apt/status";
Dir::Cache "$root/apt/cache";
CONF
  (
    export APT_CONFIG=$root/apt/apt.conf
    cd "$root/apt/packages"
    apt-get -qq update
    apt-get -qq download "${packages[@]}"
    for package in *.deb; do dpkg -x "$package" "$root"; done
  )
  rm -r "$root/apt"
  # Links that lead out of the folder are turned back into it.
  find "$root" -type l -lname '/*' | while read -r link; do
    ln -sfn "$(realpath -ms --relative-to="$(dirname "$link")" "$root$(readlink "$link")")" "$link"
  done
  # CMake looks whether everything is there that the packages could have; nobody links it.
  sed -n 's,.*"${_IMPORT_PREFIX}/\(lib/[^" ]*\)".*,\1,p' "$root"/usr/lib/*/cmake/sundials/*.cmake | sort -u |
    while read -r file; do [ -e "$root/usr/$file" ] || : >"$root/usr/$file"; done
  # pkg-config would ask for everything that cairo could be linked with.
  printf 'Name: cairo\nDescription: cairo\nVersion: 1.16.0\nLibs: -lcairo\nCflags: -I/usr/include/cairo\n' \
    >"$root/pkgconfig/cairo.pc"
  printf 'Name: cpp-httplib\nDescription: cpp-httplib\nVersion: 0.11.4\nLibs: -lcpp-httplib\nCflags:\n' \
    >"$root/pkgconfig/cpp-httplib.pc"
  say "export BRINK_AARCH64_SYSROOT=$root"
}

if [ "${1:-}" = sysroot ]; then
  make_sysroot "${2:?usage: tests/same_bits.sh sysroot FOLDER}"
  exit
fi

missing() {  # BUILD: prints what it lacks
  case $1 in
    gcc-*) command -v g++ >/dev/null || echo "g++" ;;
    clang-*) command -v clang++ >/dev/null || echo "clang++" ;;
    aarch64-*)
      for tool in aarch64-linux-gnu-g++ qemu-aarch64-static; do command -v $tool >/dev/null || echo "$tool"; done
      [ -n "${BRINK_AARCH64_SYSROOT:-}" ] || echo "BRINK_AARCH64_SYSROOT"
      ;;
    *) say "unknown build \"$1\""; exit 2 ;;
  esac
}

build_and_run() {  # BUILD
  local options=(-DCMAKE_BUILD_TYPE=Release -DBRINK_UNITY=ON -DBRINK_TESTS=ON) run=()
  case $1 in
    *-O2) options+=("-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG") ;;
    *-native) options+=(-DCMAKE_CXX_FLAGS=-march=native) ;;
  esac
  case $1 in
    gcc-*) options+=(-DCMAKE_CXX_COMPILER=g++) ;;
    clang-*) options+=(-DCMAKE_CXX_COMPILER=clang++) ;;
    aarch64-*)
      options+=("-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/aarch64.cmake")
      run=(qemu-aarch64-static -L "$BRINK_AARCH64_SYSROOT")
      ;;
  esac
  {
    cmake -S . -B "$folder/$1" $(command -v ninja >/dev/null && echo -G Ninja) "${options[@]}" &&
      cmake --build "$folder/$1" -j "$jobs" --target regression_answers_test &&
      BRINK_STORE_ANSWERS=$PWD/$folder/$1.csv "${run[@]}" "$folder/$1/tests/regression_answers_test" \
        --gtest_filter='AnswersTable.*'
  } >"$folder/$1.log" 2>&1 || { tail -n 40 "$folder/$1.log" >&2; say "$1: failed"; exit 1; }
}

mkdir -p "$folder"
builds=() tables=()
[ $# -gt 0 ] || set -- gcc-O3 gcc-O2 clang-O3 clang-O2 aarch64-O3 aarch64-O2
for build in "$@"; do
  lacks=$(missing "$build" | paste -sd' ')
  if [ -n "$lacks" ]; then
    say "$build: left out, there is no $lacks"
    continue
  fi
  begin=$(date +%s)
  build_and_run "$build"
  say "$build: run ($(($(date +%s) - begin)) s)"
  builds+=("$build")
  tables+=("$folder/$build.csv")
done
[ ${#builds[@]} -gt 0 ] || exit 0

# A row a scene; the solver's are told by the last column of the tables.
awk -F, -v names="${builds[*]}" '
  FNR == 1 { ++file }
  /^#/ { next }
  { hash[$1, file] = $6; if (file == 1) scenes[++count] = $1; if ($NF == "solver") solver[$1] = 1 }
  END {
    builds = split(names, name, " ")
    printf "%-22s", "scene"
    for (b = 1; b <= builds; ++b) printf "  %-16s", name[b]
    print ""
    for (k = 1; k <= count; ++k) {
      scene = scenes[k]
      printf "%-22s", scene
      different = 0
      for (b = 1; b <= builds; ++b) {
        same = b > 1 && hash[scene, b] == hash[scene, 1]
        printf "  %-16s", same ? "=" : hash[scene, b]
        if (b > 1 && !same) different = 1
      }
      print solver[scene] ? "  solver" : different ? "  DIFFERENT" : ""
      if (different && !solver[scene]) status = 1
      if (different && solver[scene]) ++let_off
    }
    printf "%d scenes, %d builds: %s; %d that need a solver differ\n", count, builds,
      status ? "hashes DIFFER" : "the same hashes where none needs a solver", let_off
    exit status
  }' "${tables[@]}"
