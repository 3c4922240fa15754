#!/usr/bin/env bash
# Mistakes that the compiler must refuse: see compile_errors.cpp.
# Arguments: the compiler, the source directory.
set -euo pipefail
compiler=$1 source=$2
compile() {
  "$compiler" -std=c++20 -ffp-contract=off -fsyntax-only -Werror=format -I"$source" -DFAULT="$1" \
    "$source/tests/determinism/compile_errors.cpp" 2>&1
}
if ! out=$(compile 0); then
  echo "FAILED: the healthy kernel does not compile"; echo "$out"; exit 1
fi
failed=0
expect() {  # fault, what, pattern of the refusal
  local out
  if out=$(compile "$1"); then
    echo "FAILED: $2 compiles"; failed=1
  elif ! grep -qE "$3" <<<"$out"; then
    echo "FAILED: $2 is refused for another reason:"; echo "$out"; failed=1
  else
    echo "refused, as it must be: $2"
  fi
}
expect 1 "a port missing from kPorts" "Out<.*OrderBlock>|no matching constructor|no matching function"
expect 2 "ports in another order" "could not convert|no viable conversion|no matching"
expect 3 "a write through In" "read-only (object|location)|const-qualified|not assignable"
expect 4 "parameters that are not plain data" "is_trivially_copyable"
expect 5 "a block that is no legal DMA transfer" "legal DMA transfer"
exit $failed
