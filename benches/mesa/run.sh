#!/bin/sh
# Shadow-map drawing against Mesa llvmpipe, two threads each, taking turns in one run; medians, ratios, map comparison.
#   benches/mesa/run.sh [TURNS] [OUTPUT_DIRECTORY]
set -eu
cd "$(dirname "$0")/../.."
turns=${1:-5}
out=${2:-$(mktemp -d)}
mkdir -p "$out"
sizes=1024,2048,4096
log=$out/rounds.jsonl
: >"$log"
export LP_NUM_THREADS=2 LIBGL_ALWAYS_SOFTWARE=1

cargo bench --bench raster -- --export "$out/scene.bin" --depth "$out/lixel" --rounds 1 --sizes $sizes >/dev/null
turn=1
while [ "$turn" -le "$turns" ]; do
    cargo bench --quiet --bench raster -- --rounds 7 --threads 2 --sizes $sizes >>"$log"
    python3 benches/mesa/llvmpipe.py "$out/scene.bin" --rounds 7 --sizes $sizes --depth "$out/lixel" >>"$log"
    turn=$((turn + 1))
done
python3 benches/mesa/llvmpipe.py --summary "$log"
