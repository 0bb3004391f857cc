#!/bin/sh
# Boots a small plant of simulated devices:
#   sh examples/boot-network/run.sh          on a virtual bus, needs nothing
#   sh examples/boot-network/run.sh vcan0    on a SocketCAN interface that is up
# Installs what the build needs (Debian, as root or through sudo) and builds.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
top=$(cd "$here/../.." && pwd)
build=${MCANOPEN_BUILD:-$top/build/demo}
bus=${1:-virtual:demo}
export MCANOPEN_NET_0="$bus"

missing=
for package in gcc cmake ninja-build pkg-config libxml2-dev libc6-dev; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
        missing="$missing $package"
done
if [ -n "$missing" ]; then
    echo "== installing:$missing"
    sudo=
    [ "$(id -u)" = 0 ] || sudo=sudo
    $sudo apt-get update -q >/dev/null
    $sudo env DEBIAN_FRONTEND=noninteractive \
        apt-get install -q -y --no-install-recommends $missing >/dev/null
fi

mkdir -p "$build"
echo "== building in ${build#"$top"/}"
if ! { cmake -S "$top" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo \
           -DMCANOPEN_TESTS=OFF && cmake --build "$build"; } >"$build.log" 2>&1; then
    cat "$build.log"
    exit 2
fi

echo "== four simulated devices on $bus"
"$build/tools/mcanopen" sim -q --bus "$bus" "$here/network.xml" >"$build.sim.log" 2>&1 &
sim=$!
trap 'kill $sim 2>/dev/null || true' EXIT
trap 'exit 130' INT TERM
until grep -q 'simulated devices on' "$build.sim.log"; do
    if ! kill -0 $sim 2>/dev/null; then
        cat "$build.sim.log"
        exit 3
    fi
    sleep 0.05
done

echo "== mcanopen boot --once --all examples/boot-network/network.xml"
"$build/tools/mcanopen" boot --once --all "$here/network.xml"
