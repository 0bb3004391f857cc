#!/bin/sh
# The measurements of tests/bench work: a few frames of each kind, nothing is judged. Runs in
# tests/vcan/run.sh.
set -eu
exec sh tests/bench/run.sh --smoke --build "$MCANOPEN_BUILD" --bus vcan0
