#!/bin/sh
# Fetches the 32-bit libraries that the preset m32 links against: sh tests/m32_libs.sh DIR
#
# apt works here with an i386 state of its own below DIR: the machine gets no foreign architecture,
# whose packages would have to match the version of each installed one. The headers are those of
# the installed libxml2-dev, libjansson-dev and check; they are the same for all architectures.
set -eu

packages="libxml2 libicu72 liblzma5 zlib1g libstdc++6 libgcc-s1 check libsubunit-dev
    libjansson4 libjansson-dev"
dir=$1

# What was made for another list is made anew.
if [ "$(cat "$dir/complete" 2>/dev/null)" = "$packages" ]; then
    exit 0
fi
rm -rf "$dir"

# The first configured source of the release's main component: "deb [...] URI SUITE main".
debian_source()
{
    codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    uri=$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' \
        'Created-By: Packages' | sed -n "s/^$codename main //p" | head -n 1)
    keys=/usr/share/keyrings/debian-archive-keyring.gpg
    echo "deb [signed-by=$keys] ${uri:-http://deb.debian.org/debian} $codename main"
}

configure_apt()
{
    mkdir -p "$dir/apt/lists/partial" "$dir/apt/cache/archives/partial" "$dir/debs"
    debian_source >"$dir/apt/sources.list"
    cat >"$dir/apt/apt.conf" <<END
APT::Architecture "i386";
APT::Architectures "i386";
APT::Sandbox::User "";
Dir::Etc::sourcelist "$dir/apt/sources.list";
Dir::Etc::sourceparts "/dev/null";
Dir::State "$dir/apt";
Dir::State::status "/dev/null";
Dir::Cache "$dir/apt/cache";
Acquire::Languages "none";
END
}

unpack()
{
    for package in "$dir"/debs/*.deb; do
        dpkg-deb -x "$package" "$dir/root"
    done
    mkdir -p "$dir/lib"
    find "$dir/root/lib" "$dir/root/usr/lib" -path '*i386-linux-gnu*' \
        \( -name '*.so*' -o -name '*.a' \) -exec cp -P {} "$dir/lib" \;
    ln -sf libxml2.so.2 "$dir/lib/libxml2.so"
    rm "$dir/lib/libsubunit.so"
    sed -e "s|^libdir=.*|libdir=$dir/lib|" -e /^Requires:/d -e 's/^Libs:.*/& -lsubunit/' \
        "$dir/root/usr/lib/i386-linux-gnu/pkgconfig/check.pc" >"$dir/lib/check.pc"
    sed "s|^libdir=.*|libdir=$dir/lib|" \
        "$dir/root/usr/lib/i386-linux-gnu/pkgconfig/jansson.pc" >"$dir/lib/jansson.pc"
}

mkdir -p "$dir"
dir=$(cd "$dir" && pwd)
configure_apt
APT_CONFIG=$dir/apt/apt.conf
export APT_CONFIG
apt-get update -qq
# shellcheck disable=SC2086 # a list of words
(cd "$dir/debs" && apt-get download -qq $packages)
unpack
rm -rf "$dir/apt" "$dir/debs" "$dir/root"
echo "$packages" >"$dir/complete"
