#!/usr/bin/env bash
# Stack that the kernels of a 43-state filter take in a release build, in bytes: what each function of the core pushes and
# subtracts from the stack pointer, read off the program that benches/instructions.sh counts. The kernels call nothing but
# memcpy and their like; what calls them is listed too. Fails where a kernel and its caller, which stand on the stack together,
# take 8 kB or more.
set -euo pipefail
cd "$(dirname "$0")/counted"
target=${CARGO_TARGET_DIR:-$(cd ../.. && pwd)/target}
# names that say which kernel a function was made for
RUSTFLAGS="${RUSTFLAGS:-} -C symbol-mangling-version=v0" cargo build --quiet --release --target-dir "$target/stack"
frames=$(
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
)
echo "$frames"

# the largest frame of a name; propagation is the same code, under one of their names, for any number of measurements
largest() {
    awk -v name="$1" '$0 ~ name && $1 > most { most = $1 } END { print most + 0 }' <<< "$frames"
}
echo
status=0
while IFS='|' read -r what kernel caller; do
    kernel=$(largest "$kernel") caller=$(largest "$caller")
    printf '%-26s %5d + %4d = %5d bytes with its caller\n' "$what" "$kernel" "$caller" $((kernel + caller))
    # a name that is not found any more shall not pass; a filter with a form of its own, as the pilot, is not the caller
    if ((kernel == 0 || caller == 0 || kernel + caller >= 8000)); then
        status=1
    fi
done << 'END'
conventional, propagation|conventional::Conventional as .*::propagate<.*Dim<43, 9, .>|Kalman<[^,]*>>::predict$
conventional, update|conventional::Conventional as .*::update<.*Dim<43, 9, 6>|Kalman<[^,]*>>::update$
UD, propagation|ud::Ud as .*::propagate<.*Dim<43, 9, .>|Kalman<[^,]*>>::predict$
UD, update|ud::Ud as .*::update<.*Dim<43, 9, 6>|Kalman<[^,]*>>::update$
step of [Phi Psi]|Transition<.*>>::advance::|Transition<.*>>::advance$
END
exit $status
