#!/usr/bin/env bash
# In the gate: every mutation's sites still stand in the sources, each once, and what checks that works. The suite
# itself takes an hour (run.py).
set -euo pipefail
cd "$(dirname "$0")"
python3 -c 'import sys; sys.exit(sys.version_info < (3, 9))' 2>/dev/null || { echo "SKIPPED: no python3 from 3.9 on"; exit 77; }
python3 sites_test.py
python3 run.py check
