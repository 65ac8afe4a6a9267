#!/usr/bin/env bash
# Makes a page of replays of the whole gallery: docs/make_gallery.sh [FOLDER]   (default: build/gallery; open its index.html)
# Each scene is run, its replay page written, and a thumbnail drawn from the same run. Nothing of it is committed.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
folder=${1:-$root/build/gallery}
brink=$root/build/release/bin/brink
[ -x "$brink" ] || "$root/brink" --version >/dev/null
mkdir -p "$folder"

# What a thumbnail shows of a scene that is long and flat, instead of all of it.
declare -A views=([curling]=9,-2,17,4)

title_of() { sed -n 's/^title *= *"\(.*\)".*/\1/p' "$1" | head -n 1 | sed 's/&/\&amp;/g; s/</\&lt;/g; s/>/\&gt;/g'; }

{
  cat <<'HTML'
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Brink: gallery</title>
<style>
:root { color-scheme: light dark; }
body { font: 15px/1.4 system-ui, sans-serif; margin: 1.5em; }
main { display: grid; grid-template-columns: repeat(auto-fill, minmax(17em, 1fr)); gap: 1em; }
a { color: inherit; text-decoration: none; border: 1px solid #8884; border-radius: 6px; overflow: hidden; }
a:hover, a:focus { outline: 2px solid #1f5fbf; }
img { width: 100%; display: block; }
span { display: block; padding: .4em .7em; }
</style></head><body><h1>Brink: gallery</h1><p>Each picture opens the scene's replay.</p><main>
HTML
  for scene in "$root"/scenes/gallery/*.toml; do
    name=$(basename "$scene" .toml)
    printf '%s\n' "$name" >&2
    rm -rf "$folder/runs/$name"
    "$brink" run "$scene" --out "$folder/runs/$name" --quiet || continue
    "$brink" view "$folder/runs/$name" -o "$folder/$name.html" >/dev/null
    end=$("$brink" export "$folder/runs/$name" --csv "$folder/runs/$name" && tail -n 1 "$folder/runs/$name/frames.csv" | cut -d, -f1)
    "$brink" draw "$folder/runs/$name" --at "$(awk -v t="$end" 'BEGIN { print 0.4 * t }')" --size 480x360 \
      ${views[$name]:+--view "${views[$name]}"} -o "$folder/$name.png"
    printf '<a href="%s.html"><img src="%s.png" alt="" loading="lazy"><span>%s</span></a>\n' "$name" "$name" "$(title_of "$scene")"
  done
  printf '</main></body></html>\n'
} >"$folder/index.html"
printf '%s\n' "$folder/index.html"
