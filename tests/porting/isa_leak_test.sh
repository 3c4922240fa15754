#!/usr/bin/env bash
# Instruction sets must not leak into each other.
#
# 1. No weak or unique symbol is defined by the objects of more than one instruction set: the linker
#    would keep one of the bodies for all, and an AVX-512 one could be reached on the SSE4 path.
# 2. No object holds instructions of a larger set than its own: none with a VEX or EVEX prefix in the
#    objects of sse4 and reference, no EVEX, opmask or 512-bit register in avx2's.
# 3. The check itself works: avx2's object fails rule 2 as if it were sse4's, avx512's as avx2's.
#
# Arguments: name=object[,object...] for each instruction set, in any order.
set -euo pipefail
export LC_ALL=C
[ $# -ge 2 ] || { echo "usage: isa_leak_test.sh sse4=a.o avx2=b.o ..." >&2; exit 2; }
command -v nm >/dev/null && command -v objdump >/dev/null || { echo "binutils are missing" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

# Demangled lines `<function>: <instruction>` of an object that rule 2 forbids for this set.
forbidden() {  # set, object
  # objdump prints: address, bytes, mnemonic, operands. VEX and EVEX mnemonics begin with v (but for the
  # old verr, verw and the virtualisation instructions) or with k (opmasks).
  objdump -d --no-show-raw-insn "$2" | awk -v set="$1" '
    /^[0-9a-f]+ <.*>:$/ { name = $2; next }
    NF < 2 { next }
    {
      mnemonic = $2
      if (mnemonic ~ /^(verr|verw|vmcall|vmfunc|vmlaunch|vmload|vmmcall|vmresume|vmrun|vmsave)$/) next
      bad = 0
      if (set == "sse4" || set == "reference") {
        bad = mnemonic ~ /^v/ || mnemonic ~ /^k(mov|and|or|not|xor|xnor|add|shift|test|unpck|ortest)/ || $0 ~ /%[yz]mm/
      } else if (set == "avx2") {
        bad = $0 ~ /%zmm/ || $0 ~ /%k[0-7]/ || $0 ~ /%[xy]mm(1[6-9]|2[0-9]|3[01])/ || mnemonic ~ /^vf(n?m)(add|sub)/
      } else if (set == "avx512") {
        bad = mnemonic ~ /^vf(n?m)(add|sub)/
      }
      if (mnemonic ~ /^v(rsqrt|rcp|rcp14|rsqrt14)/ || mnemonic ~ /^(rsqrt|rcp)[ps]s/) bad = 1
      if (bad && ++count <= 5) print name " " $0
    }'
}

declare -a sets=()
declare -A objects=()
for argument in "$@"; do
  set_name=${argument%%=*}
  sets+=("$set_name")
  objects[$set_name]=${argument#*=}
done

for set_name in "${sets[@]}"; do
  : >"$work/$set_name.weak"
  : >"$work/$set_name.found"
  IFS=, read -ra list <<<"${objects[$set_name]}"
  for object in "${list[@]}"; do
    [ -f "$object" ] || { echo "no object $object" >&2; exit 1; }
    nm --defined-only "$object" | awk '$2 ~ /^[WVuwv]$/ { print $3 }' >>"$work/$set_name.weak"
    forbidden "$set_name" "$object" >>"$work/$set_name.found"
    objdump -d "$object" >"$work/text"  # not a pipe: grep -q would end it early
    grep -q '<.*Kernels' "$work/text" || { echo "FAILED: $object holds no kernel table"; failed=1; }
  done
  sort -u -o "$work/$set_name.weak" "$work/$set_name.weak"
  if [ -s "$work/$set_name.found" ]; then
    echo "FAILED: $set_name holds instructions of a larger set, a fused multiply-add or an estimate:"
    head -n 5 "$work/$set_name.found" | c++filt
    failed=1
  fi
done

for ((i = 0; i < ${#sets[@]}; ++i)); do
  for ((j = i + 1; j < ${#sets[@]}; ++j)); do
    comm -12 "$work/${sets[i]}.weak" "$work/${sets[j]}.weak" >"$work/both"
    if [ -s "$work/both" ]; then
      echo "FAILED: weak symbols in both ${sets[i]} and ${sets[j]}:"
      head -n 10 "$work/both" | c++filt
      failed=1
    fi
  done
done

expect_caught() {  # the set whose object is tried, the set it claims to be
  [ -n "${objects[$1]:-}" ] || return 0
  if [ -z "$(forbidden "$2" "${objects[$1]%%,*}")" ]; then
    echo "FAILED: the check would not notice $1's instructions in $2"
    failed=1
  fi
}
expect_caught avx2 sse4
expect_caught avx512 sse4
expect_caught avx512 avx2

[ "$failed" -eq 0 ] && echo "no leaks: $(printf '%s ' "${sets[@]}")"
exit "$failed"
