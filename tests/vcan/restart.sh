#!/bin/sh
# Managers that are killed or stopped, and one that takes over: tests/system/test_restart.py and a
# part of test_killed.py on interfaces that they make. Runs in tests/vcan/run.sh.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=new
MCANOPEN_TEST_BRIEF=yes
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS MCANOPEN_TEST_BRIEF
python3 -B tests/system/test_restart.py Restart.test_kept_alive Restart.test_manager_hangs
python3 -B tests/system/test_killed.py Killed.test_manager_hangs
