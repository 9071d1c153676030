#!/usr/bin/env bash
# Stack that the kernels of a 43-state filter take in a release build, in bytes: what each function of the core pushes and
# subtracts from the stack pointer, read off the program that benches/instructions.sh counts. The kernels call nothing but
# memcpy and their like; what calls them is listed too.
set -euo pipefail
cd "$(dirname "$0")/counted"
target=${CARGO_TARGET_DIR:-$(cd ../.. && pwd)/target}
# names that say which kernel a function was made for
RUSTFLAGS="${RUSTFLAGS:-} -C symbol-mangling-version=v0" cargo build --quiet --release --target-dir "$target/stack"
objdump --disassemble --demangle --no-show-raw-insn "$target/stack/release/counted" |
    sed -n -E 's/^[0-9a-f]+ <(.*)>:$/function \1/p; s/.*\tpush .*/push/p; s/.*\tsub +\$0x([0-9a-f]+),%rsp$/sub \1/p' |
    while read -r what rest; do
        case $what in
        function)
            [[ ${name:-} == *calib_core* ]] && printf '%6d  %s\n' "$bytes" "${name//fearless_simd::generated::/}"
            name=$rest bytes=0
            ;;
        push) bytes=$((bytes + 8)) ;;
        sub) bytes=$((bytes + 16#$rest)) ;;
        esac
    done | awk '$1 > 256' | sort -rn
