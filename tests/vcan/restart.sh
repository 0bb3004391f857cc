#!/bin/sh
# A manager that ends, and another one: tests/system/test_restart.py on interfaces that
# it makes. Runs in tests/vcan/run.sh.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=new
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS
exec python3 -B tests/system/test_restart.py Restart.test_kept_alive Restart.test_manager_hangs
