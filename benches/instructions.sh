#!/usr/bin/env bash
# Instructions of one 43-state cycle of either form and of one navigation step, counted by valgrind: they do not depend on how busy
# the machine is. Fails beyond the bounds below, which lie a tenth above what they were when they were set. valgrind knows AVX2 and
# no AVX-512: it counts what a processor with AVX2 runs in a default build.
#
#   bash benches/instructions.sh            the three, with their bounds
#   bash benches/instructions.sh growth     cycles of 15 to 90 states, 9 leading ones, and of 1 to 9 measurements
set -euo pipefail
cd "$(dirname "$0")/counted"

#       what         few  many  at most
bounds="conventional 100  1100  31000
        ud           100  1100  46900
        navigation   2000 42000 3100"

if ! command -v valgrind > /dev/null; then
    echo "no valgrind: instructions are not counted"
    exit 0
fi
target=${CARGO_TARGET_DIR:-$(cd ../.. && pwd)/target}
cargo build --quiet --release --target-dir "$target/counted"

# instructions of a run
count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$target/counted/release/counted" "$1" "$2" 2>&1 |
        sed -n 's/.*Collected : //p'
}

# instructions of one more: of what, from so few to so many
each() {
    echo $((($(count "$1" "$3") - $(count "$1" "$2")) / ($3 - $2)))
}

if [[ ${1:-} == growth ]]; then
    for size in 15:6 21:6 30:6 36:6 43:6 60:6 90:6 43:1 43:3 43:9; do
        printf '%d states, %d measurements: %6d conventional, %6d ud\n' "${size%:*}" "${size#*:}" \
            "$(each conventional:$size 10 110)" "$(each ud:$size 10 110)"
    done
    exit 0
fi
status=0
while read -r what few many bound; do
    each=$(each "$what" "$few" "$many")
    printf '%-14s %6d instructions, at most %d\n' "$what" "$each" "$bound"
    if ((each > bound)); then
        status=1
    fi
done <<< "$bounds"
exit $status
