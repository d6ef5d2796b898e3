# Sourced by the scripts beside it: finds a program of the build and the components.
#   BUILD  folder of a Release build; default: build/release
root=$(dirname "$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)")
build=${BUILD:-$root/build/release}
export BRAMAH_PLUGIN_PATH=${BRAMAH_PLUGIN_PATH:-$build/lib/bramah/plugins}

# program NAME: its path, or a message.
program() {
  if [[ ! -x $build/bin/$1 ]]; then
    echo "no $build/bin/$1: build the target $1 first (cmake --build $build --target $1)" >&2
    return 1
  fi
  echo "$build/bin/$1"
}
