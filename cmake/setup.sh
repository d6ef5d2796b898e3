# Shared by ./run and ./test, which source it with `root` set to the directory of the repository.
# Everything said here goes to standard error: standard output belongs to the program.

# The first list builds and runs Bramah; the second is for its tests and benchmarks. Both commands install both, so that
# one build directory serves both.
bramah_packages=(
  g++ cmake ninja-build git pkg-config ccache
  libeigen3-dev libsuitesparse-dev libsundials-dev liblapack-dev libblas-dev nlohmann-json3-dev libcli11-dev
  libtbb-dev libspectra-dev
  libgtest-dev libgmock-dev libbenchmark-dev)

say() { printf 'bramah: %s\n' "$*" >&2; }

# Runs a command silently; if it fails, shows what it wrote and stops.
quietly() {
  local what="$1" log
  shift
  log="$(mktemp)"
  if ! "$@" >"$log" 2>&1 </dev/null; then
    cat "$log" >&2
    rm -f "$log"
    say "$what failed; its messages are above"
    exit 1
  fi
  rm -f "$log"
}

install_missing() {
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    check_tools
    return
  fi
  local installed missing=() package as_root=()
  installed=" $(dpkg-query -W -f '${Package}=${db:Status-Status} ' "${bramah_packages[@]}" 2>/dev/null || true)"
  for package in "${bramah_packages[@]}"; do
    [[ "$installed" == *" $package=installed "* ]] || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      say "these packages are missing, and installing them takes root (there is no sudo here). As root:"
      say "  apt-get install --no-install-recommends ${missing[*]}"
      exit 1
    fi
    as_root=(sudo)
  fi
  say "installing what is needed to build it, once: ${missing[*]}"
  as_root+=(env DEBIAN_FRONTEND=noninteractive)
  quietly "apt-get update" "${as_root[@]}" apt-get update
  quietly "apt-get install" "${as_root[@]}" apt-get install -y --no-install-recommends "${missing[@]}"
}

# Without apt-get nothing is installed: CMake names a missing library, this a missing tool.
check_tools() {
  local tool missing=()
  for tool in cmake ninja; do
    command -v "$tool" >/dev/null || missing+=("$tool")
  done
  command -v "${CXX:-c++}" >/dev/null || missing+=("a C++20 compiler")
  ((${#missing[@]})) || return 0
  say "missing here: ${missing[*]}"
  say "Bramah needs: a C++20 compiler, CMake 3.22, Ninja, Eigen 3.4, SuiteSparse (KLU), SUNDIALS 6 (IDA), LAPACK,"
  say "nlohmann-json 3.11, CLI11 2, oneTBB 2021, Spectra 1; for the tests GoogleTest, Google Benchmark and SuiteSparse's SPQR and UMFPACK."
  say "On Debian and its relatives this command installs them; elsewhere use your package manager, then call it again."
  exit 1
}

# Ninja's output: the step it is at on one line of a terminal, nothing elsewhere; in both, all that compilers say and
# what CMake complains of.
show_build() {
  local line erase=''
  if [ -t 2 ]; then erase=$'\r\033[K'; fi
  while IFS= read -r line; do
    case "$line" in
      '['*/*']'*) if [ -t 2 ]; then printf '%s%.79s' "$erase" "$line" >&2; fi ;;
      'ninja: no work to do.' | '-- '* | '') ;;
      *) printf '%s%s\n' "$erase" "$line" >&2 ;;
    esac
  done
  printf '%s' "$erase" >&2
}

# build <preset> <targets...>: configures unless that is done, then builds. CMake configures again by itself when needed.
build() {
  local preset="$1" folder="$root/build/$1"
  shift
  if [ ! -f "$folder/build.ninja" ]; then
    say "building for the first time, which takes some minutes"
    (cd "$root" && quietly "cmake --preset $preset" cmake --preset "$preset")
  fi
  if ! (cd "$folder" && ninja "$@" </dev/null 2>&1 | show_build); then
    say "the build failed; the messages are above"
    exit 1
  fi
}
