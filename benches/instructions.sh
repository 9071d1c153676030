#!/usr/bin/env bash
# Instructions of one 43-state cycle of either form and of one navigation step, counted by valgrind: they do not depend on how busy
# the machine is. Fails beyond the bounds below, which lie a tenth above what they were when they were set. valgrind knows AVX2 and
# no AVX-512: it counts what a processor with AVX2 runs in a default build.
set -euo pipefail
cd "$(dirname "$0")/counted"

#       what         few  many  at most
bounds="conventional 100  1100  0
        ud           100  1100  0
        navigation   2000 42000 0"

if ! command -v valgrind > /dev/null; then
    echo "no valgrind: instructions are not counted"
    exit 0
fi
target=${CARGO_TARGET_DIR:-$(cd ../.. && pwd)/target}
cargo build --quiet --release --target-dir "$target/counted"

count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$target/counted/release/counted" "$1" "$2" 2>&1 |
        sed -n 's/.*Collected : //p'
}

status=0
while read -r what few many bound; do
    each=$((($(count "$what" "$many") - $(count "$what" "$few")) / (many - few)))
    printf '%-14s %6d instructions, at most %d\n' "$what" "$each" "$bound"
    if ((each > bound)); then
        status=1
    fi
done <<< "$bounds"
exit $status
