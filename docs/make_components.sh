#!/usr/bin/env bash
# Writes docs/components.md to standard output, from what the program says about its own libraries:
#   docs/make_components.sh > docs/components.md
#   docs/make_components.sh build/debug/bin/bramah > docs/components.md
set -eu -o pipefail
bramah="${1:-$(dirname "${BASH_SOURCE[0]}")/../build/release/bin/bramah}"
unset BRAMAH_PLUGIN_PATH  # the shipped libraries only

cat <<'END'
# Components

Made by `docs/make_components.sh` from `bramah list` and `bramah describe`; do not edit. Each type's equations stand on top
of its header, `components/<library>/<name>.hpp`. How scenes use types: [scenes](scenes.md).
END

library=
"$bramah" list --json | sed -n 's/^ *{"type": "\([^"]*\)".*/\1/p' | while read -r type; do
  if [ "${type%%/*}" != "$library" ]; then
    library="${type%%/*}"
    printf '\n## %s\n' "$library"
  fi
  printf "\n### %s\n\n\`\`\`text\n" "$type"
  # The first two lines repeat the heading and name the version.
  "$bramah" describe "$type" | sed -e "1s|^$type: ||" -e '2d'
  printf '```\n'
done
