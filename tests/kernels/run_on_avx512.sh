#!/usr/bin/env bash
# Runs a program that is compiled for AVX-512 where the processor has it, and says so where not (77:
# ctest shows the test as skipped).
set -euo pipefail
for feature in avx512f avx512dq avx512bw avx512vl; do
  if ! grep -qw "$feature" /proc/cpuinfo; then
    echo "SKIPPED: this processor has no $feature"
    exit 77
  fi
done
exec "$@"
