# What the run.sh of each example begins with: . "$(dirname "$0")/../common.sh"
#
# Installs what the build needs (Debian, as root or through sudo) and builds. Takes the bus from $1
# (virtual:demo). Sets here (the example's folder), top (of the sources), build, tools and bus.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
top=$(cd "$here/../.." && pwd)
build=${MCANOPEN_BUILD:-$top/build/demo}
tools=$build/tools
bus=${1:-virtual:demo}
started=
export MCANOPEN_NET_0="$bus"

install_packages()
{
    missing=
    for package in gcc cmake ninja-build pkg-config libxml2-dev libjansson-dev libc6-dev; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
            missing="$missing $package"
    done
    [ -n "$missing" ] || return 0
    echo "== installing:$missing"
    sudo=
    [ "$(id -u)" = 0 ] || sudo=sudo
    $sudo apt-get update -q >/dev/null
    # shellcheck disable=SC2086 # a list of words
    $sudo env DEBIAN_FRONTEND=noninteractive \
        apt-get install -q -y --no-install-recommends $missing >/dev/null
}

build_all()
{
    mkdir -p "$build"
    echo "== building in ${build#"$top"/}"
    { cmake -S "$top" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo \
        -DMCANOPEN_TESTS=OFF && cmake --build "$build"; } >"$build.log" 2>&1 && return
    cat "$build.log"
    exit 2
}

# start NAME INPUT COMMAND...: in the background until the script ends; what it says goes to a log.
start()
{
    name=$1
    input=$2
    shift 2
    : >"$build.$name.log"
    "$@" <>"$input" >>"$build.$name.log" 2>&1 &
    echo $! >"$build.$name.pid"
    started="$started $!"
}

# wait_for NAME TEXT: until it has said that.
wait_for()
{
    until grep -q -e "$2" "$build.$1.log"; do
        if ! kill -0 "$(cat "$build.$1.pid")" 2>/dev/null; then
            cat "$build.$1.log"
            exit 3
        fi
        sleep 0.05
    done
}

# A pipe that may be read and written at any time, as the input of a program.
make_input()
{
    rm -f "$1"
    mkfifo "$1"
}

end_all()
{
    # shellcheck disable=SC2086 # a list of words
    [ -z "$started" ] || kill $started 2>/dev/null || true
}

trap end_all EXIT
trap 'exit 130' INT TERM
install_packages
build_all
