#!/bin/sh
# dcf2ccf from outside: sh test_tools_dcf.sh DCF2CCF CCFREAD
set -u

dcf2ccf=$1
ccfread=$2
. "$(dirname "$0")/expect.sh"

var()
{
    printf '[%s]\nParameterName=x\nDataType=%s\nAccessType=rw\nParameterValue=%s\n' "$@"
}

device()
{
    printf '[DeviceComissioning]\nNodeID=%s\nBaudrate=500\n' "$1"
    var 1017 6 500
    printf '[1400]\nParameterName=x\nObjectType=9\nSubNumber=2\n'
    # shellcheck disable=SC2016 # $NODEID is meant
    var 1400sub1 7 '$NODEID+0x200'
    printf '[1600]\nParameterName=x\nObjectType=9\nSubNumber=3\n'
    var 1600sub0 5 1
    var 1600sub1 7 0x62000108
}

# What ccfread shows, without heading and offsets.
entries_of()
{
    "$ccfread" "$1" | sed '1,2d; s/^ *[0-9]*  //'
}

listing='1017h:00       2  500 (01F4h)
1400h:01       4  2147484165 (80000205h): off, CAN-ID 205h
1600h:00       1  0 (00h)
1600h:01       4  1644167432 (62000108h): 6200h:01, 8 bits
1600h:00       1  1 (01h)
1400h:01       4  517 (00000205h): on, CAN-ID 205h'

# ---- conversion and back -----------------------------------------------------------------------

device 5 >device.dcf
expect 'dcf2ccf' 0 '' '*device.dcf: warning: *' "$dcf2ccf" device.dcf
expect 'its entries' 0 "$listing" '' entries_of device.ccf
expect 'two names' 0 '' '*' "$dcf2ccf" device.dcf two.ccf
expect '-o' 0 '' '*' "$dcf2ccf" -o three.ccf device.dcf
expect 'overwrites' 0 '' '*' "$dcf2ccf" device.dcf two.ccf
expect 'equal output' 0 '' '' cmp two.ccf device.ccf
expect 'equal output of -o' 0 '' '' cmp three.ccf device.ccf
expect 'a device as output' 0 '' '*' "$dcf2ccf" device.dcf /dev/null
same 'the device stays' 'character special file' "$(stat -c %F /dev/null)"
if [ -e /dev/full ]; then
    expect 'a full device' 2 '' '*dcf2ccf: /dev/full: No space left*' \
        "$dcf2ccf" device.dcf /dev/full
fi
mkdir sub.d
cp device.dcf sub.d/noending
expect 'a name without ending' 0 '' '*' "$dcf2ccf" sub.d/noending
expect 'its output' 0 '' '' cmp sub.d/noending.ccf device.ccf

expect '-n' 0 '' '*' "$dcf2ccf" -n 0x10 device.dcf other.ccf
expect 'its COB-ID' 0 '*1400h:01       4  528 (*' '' entries_of other.ccf
expect '--node-id, --old-style' 0 '' '*' "$dcf2ccf" --node-id=5 --old-style device.dcf old.ccf
expect 'its mapping' 0 '*
1600h:00       1  1 (01h)
1600h:01 *
1400h:01 *' '' entries_of old.ccf

device 5 >all.dcf
printf '[2000]\nParameterName=x\nDataType=5\nAccessType=rw\nDefaultValue=7\n' >>all.dcf
expect 'ParameterValues alone' 0 '' '*' "$dcf2ccf" all.dcf
expect 'their bytes' 0 '' '' cmp all.ccf device.ccf
expect '--all' 0 '' '*' "$dcf2ccf" --all all.dcf
expect 'its DefaultValue' 0 "2000h:00       1  7 (07h)
$listing" '' entries_of all.ccf

var 2000 9 'Hello' >text.dcf
expect 'text' 0 '' '*' "$dcf2ccf" text.dcf
expect 'its bytes' 0 '2000h:00       5  * "Hello"' '' entries_of text.ccf
printf '[1000]\nParameterName=x\nDataType=7\nAccessType=ro\n' >nothing.eds
expect 'nothing to write' 0 '' '*' "$dcf2ccf" nothing.eds
same 'a count of 0' 4 "$(wc -c <nothing.ccf | tr -d ' ')"

printf 'program' >sub.d/program.bin
printf '[2000]\nParameterName=x\nObjectType=2\nDownloadFile=program.bin\n' >sub.d/program.dcf
expect 'DownloadFile beside the DCF' 0 '' '*' "$dcf2ccf" sub.d/program.dcf
expect 'its contents' 0 '2000h:00       7  * "program"' '' entries_of sub.d/program.ccf

# ---- errors: exit code 2, nothing left behind ----------------------------------------------------

rm -rf bad && mkdir bad
var 2000 5 256 >bad/range.dcf
printf '[2000]\nParameterName=x\nObjectType=2\nDownloadFile=gone.bin\n' >bad/gone.dcf
printf '[2000]\nParameterName=x\nObjectType=2\nDownloadFile=../text.dcf\n' >bad/up.dcf
# shellcheck disable=SC2016 # $NODEID is meant
var 2000 7 '$NODEID+1' >bad/formula.dcf
printf 'no section' >bad/text.dcf
: >bad/empty.dcf
expect 'an error in the file' 2 '' '*bad/range.dcf:5: error: *expected, there is "256"*' \
    "$dcf2ccf" bad/range.dcf
expect 'a file that is gone' 2 '' '*bad/gone.bin: no such file*gone.dcf:1: error: *' \
    "$dcf2ccf" bad/gone.dcf
expect 'a file above' 2 '' '*bad/up.dcf:1: error: *below the folder*' "$dcf2ccf" bad/up.dcf
expect 'no node-ID' 2 '' '*give one with -n*bad/formula.dcf:5: error: *' "$dcf2ccf" bad/formula.dcf
expect 'no DCF' 2 '' '*bad/text.dcf: error: EDS or DCF text expected*' "$dcf2ccf" bad/text.dcf
expect 'an empty DCF' 2 '' '*bad/empty.dcf: error: EDS or DCF text expected*' \
    "$dcf2ccf" bad/empty.dcf
expect 'no file' 2 '' 'dcf2ccf: bad/none.dcf: no such file' "$dcf2ccf" bad/none.dcf
expect 'a folder' 2 '' 'dcf2ccf: sub.d: a folder, expected a file' "$dcf2ccf" sub.d
expect 'no folder for the output' 2 '' '*dcf2ccf: none/a.ccf: no such folder' \
    "$dcf2ccf" device.dcf none/a.ccf
expect 'a folder as output' 2 '' '*dcf2ccf: bad: *' "$dcf2ccf" device.dcf bad
expect 'the input as output' 2 '' '*dcf2ccf: device.dcf: an input, expected another file*' \
    "$dcf2ccf" device.dcf device.dcf
same 'nothing is left behind' 'empty.dcf formula.dcf gone.dcf range.dcf text.dcf up.dcf ' \
    "$(ls bad | tr '\n' ' ')"
same 'no temporary file' 0 "$(find . -name '*.ccf?*' | wc -l | tr -d ' ')"
printf 'old' >kept.ccf
expect 'an error, with an older output' 2 '' '*error*' "$dcf2ccf" bad/range.dcf kept.ccf
same 'the older output stays' old "$(cat kept.ccf)"

# /dev/stdin would do for a pipe, but not for a socket, as a remote shell has it.
on_a_socket='import socket, subprocess, sys
ours, theirs = socket.socketpair()
ours.sendall(open(sys.argv[1], "rb").read())
ours.close()
sys.exit(subprocess.run(sys.argv[2:], stdin=theirs).returncode)'
expect 'stdin that is a socket' 0 '' '*' \
    python3 -c "$on_a_socket" device.dcf "$dcf2ccf" - socket.ccf
expect 'its output' 0 '' '' cmp socket.ccf device.ccf
# shellcheck disable=SC2016 # a script
expect 'no stdin' 2 '' 'dcf2ccf: stdin: Bad file descriptor' sh -c '"$0" - x <&-' "$dcf2ccf"

# ---- usage -------------------------------------------------------------------------------------

expect 'dcf2ccf alone' 2 '' 'Usage: dcf2ccf *' "$dcf2ccf"
expect 'dcf2ccf -h' 0 'Usage: dcf2ccf *' '' "$dcf2ccf" -h
expect 'dcf2ccf --help' 0 'Usage: dcf2ccf *' '' "$dcf2ccf" --help
expect 'dcf2ccf --version' 0 'dcf2ccf [0-9]*.[0-9]*' '' "$dcf2ccf" --version
expect 'dcf2ccf without input' 2 '' '*an input file expected*' "$dcf2ccf" -n 5
expect 'dcf2ccf with too many' 2 '' '*more than*' "$dcf2ccf" device.dcf b c
expect 'dcf2ccf with two outputs' 2 '' '*one output*' "$dcf2ccf" -o a device.dcf b
expect 'dcf2ccf --foo' 2 '' '*unrecognized option*' "$dcf2ccf" --foo device.dcf
for id in 0 128 -1 5x '' 99999999999999999999; do
    expect "dcf2ccf -n '$id'" 2 '' '*1..127 expected*' "$dcf2ccf" -n "$id" device.dcf
done

expect_end
