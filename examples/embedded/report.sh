#!/usr/bin/env bash
# What the embedded example takes: code and data by `size`, stack by the smallest limit it runs within (to a page of 4 KiB).
# That is for the machine at hand. For a Cortex-M7F: `rustup target add thumbv7em-none-eabihf`, and from the root of the project
#   cargo build --release -p sinscal --no-default-features --target thumbv7em-none-eabihf
set -euo pipefail
cd "$(dirname "$0")"
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-target}/embedded"
binary=$CARGO_TARGET_DIR/release/embedded

# Smallest stack limit in KiB within which a command ends well.
stack() {
    local low=8 high=8192 middle
    while ((high - low > 4)); do
        middle=$(((low + high) / 8 * 4))
        if bash -c 'ulimit -s "$0" && exec env -i "$@"' "$middle" "$@" > /dev/null 2>&1; then high=$middle; else low=$middle; fi
    done
    echo "$high"
}

printf '%-8s %10s %10s %10s %12s\n' states "code, B" "data, B" "zeroed, B" "stack, KiB"
for states in 15 43; do
    features=(); [[ $states == 43 ]] && features=(--features full)
    cargo build --quiet --release --locked "${features[@]}"
    "$binary" || { echo "the filter of $states states did not find the bias ($?)" >&2; exit 1; }
    read -r code data zeroed _ < <(size "$binary" | tail -n 1)
    cargo build --quiet --release --locked --features measure "${features[@]}"
    used=$(($(stack "$binary") - $(stack "$binary" nothing)))
    printf '%-8s %10d %10d %10d %12d\n' "$states" "$code" "$data" "$zeroed" "$used"
done
