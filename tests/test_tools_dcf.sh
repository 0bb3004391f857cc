#!/bin/sh
# dcf2ccf and ccfread from outside: sh test_tools_dcf.sh DCF2CCF CCFREAD
set -u

dcf2ccf=$1
ccfread=$2
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
passed=0
failed=0

# expect NAME EXIT-CODE STDOUT STDERR COMMAND...: compares all three; "*" is any text
expect()
{
    name=$1
    code=$2
    out=$3
    err=$4
    shift 4
    "$@" >out 2>err </dev/null
    status=$?
    if [ $status -eq "$code" ] && matches "$out" out && matches "$err" err; then
        passed=$((passed + 1))
        return
    fi
    failed=$((failed + 1))
    echo "FAILED: $name: exit code $status, expected $code"
    sed 's/^/    out: /' out
    sed 's/^/    err: /' err
}

matches()
{
    text=$(cat "$2")
    # shellcheck disable=SC2254 # a pattern
    case $text in
    $1) return 0 ;;
    esac
    return 1
}

# same NAME TEXT TEXT
same()
{
    if [ "$2" = "$3" ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $1: '$2' is not '$3'"
    fi
}

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

listing='1017:00  2  F4 01  = 500
1400:01  4  05 02 00 80  = 2147484165
1600:00  1  00  = 0
1600:01  4  08 01 00 62  = 1644167432
1600:00  1  01  = 1
1400:01  4  05 02 00 00  = 517'

# ---- conversion and back -----------------------------------------------------------------------

device 5 >device.dcf
expect 'dcf2ccf' 0 '' '*device.dcf: warning: *' "$dcf2ccf" device.dcf
expect 'ccfread' 0 "$listing" '' "$ccfread" device.ccf
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
expect 'its COB-ID' 0 '*1400:01  4  10 02 00 00  = 528' '' "$ccfread" other.ccf
expect '--node-id, --old-style' 0 '' '*' "$dcf2ccf" --node-id=5 --old-style device.dcf old.ccf
expect 'its mapping' 0 '*
1600:00  1  01  = 1
1600:01  4  08 01 00 62  = 1644167432
1400:01*' '' "$ccfread" old.ccf

device 5 >all.dcf
printf '[2000]\nParameterName=x\nDataType=5\nAccessType=rw\nDefaultValue=7\n' >>all.dcf
expect 'ParameterValues alone' 0 '' '*' "$dcf2ccf" all.dcf
expect 'their bytes' 0 '' '' cmp all.ccf device.ccf
expect '--all' 0 '' '*' "$dcf2ccf" --all all.dcf
expect 'its DefaultValue' 0 "2000:00  1  07  = 7
$listing" '' "$ccfread" all.ccf

var 2000 9 'Hello' >text.dcf
expect 'text' 0 '' '*' "$dcf2ccf" text.dcf
expect 'ccfread of text' 0 '2000:00  5  48 65 6C 6C 6F  = 478560413000  "Hello"' '' \
    "$ccfread" text.ccf
expect 'ccfread --json' 0 '[[]
  {"index": 8192, "sub": 0, "size": 5, "data": "48656C6C6F", "value": 478560413000}
]' '' "$ccfread" --json text.ccf
if command -v python3 >/dev/null; then
    "$ccfread" --json device.ccf >json
    count='import json; print(len(json.load(open("json"))))'
    same 'JSON that others read' 6 "$(python3 -c "$count")"
fi
printf '[1000]\nParameterName=x\nDataType=7\nAccessType=ro\n' >nothing.eds
expect 'nothing to write' 0 '' '*' "$dcf2ccf" nothing.eds
same 'a count of 0' 4 "$(wc -c <nothing.ccf | tr -d ' ')"
expect 'ccfread of nothing' 0 '' '' "$ccfread" nothing.ccf
expect 'ccfread --json of nothing' 0 '[[]]' '' "$ccfread" --json nothing.ccf

printf 'program' >sub.d/program.bin
printf '[2000]\nParameterName=x\nObjectType=2\nDownloadFile=program.bin\n' >sub.d/program.dcf
expect 'DownloadFile beside the DCF' 0 '' '*' "$dcf2ccf" sub.d/program.dcf
expect 'its contents' 0 '2000:00  7  70 72 6F 67 72 61 6D  = * "program"' '' \
    "$ccfread" sub.d/program.ccf

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
same 'no temporary file' 0 "$(find . -name '*.ccf.*' | wc -l | tr -d ' ')"
printf 'old' >kept.ccf
expect 'an error, with an older output' 2 '' '*error*' "$dcf2ccf" bad/range.dcf kept.ccf
same 'the older output stays' old "$(cat kept.ccf)"

printf '\002\000\000\000\027\020\000\002\000\000\000\350' >bad.ccf
expect 'ccfread of a truncated file' 2 '' \
    'bad.ccf: error: entry 1 of 2 at byte 4 (1017h:00): a value of 2 bytes expected, 1 are left' \
    "$ccfread" bad.ccf
expect 'ccfread of no file' 2 '' 'ccfread: none.ccf: no such file' "$ccfread" none.ccf

# ---- usage -------------------------------------------------------------------------------------

expect 'dcf2ccf alone' 2 '' 'Usage: dcf2ccf *' "$dcf2ccf"
expect 'dcf2ccf -h' 0 'Usage: dcf2ccf *' '' "$dcf2ccf" -h
expect 'dcf2ccf --help' 0 'Usage: dcf2ccf *' '' "$dcf2ccf" --help
expect 'dcf2ccf --version' 0 'dcf2ccf [0-9]*.[0-9]*' '' "$dcf2ccf" --version
expect 'dcf2ccf without input' 2 '' '*an input file expected*' "$dcf2ccf" -n 5
expect 'dcf2ccf with too many' 2 '' '*more than*' "$dcf2ccf" device.dcf b c
expect 'dcf2ccf with two outputs' 2 '' '*one output*' "$dcf2ccf" -o a device.dcf b
expect 'dcf2ccf --foo' 2 '' '*unknown option*' "$dcf2ccf" --foo device.dcf
for id in 0 128 -1 5x '' 99999999999999999999; do
    expect "dcf2ccf -n '$id'" 2 '' '*1..127 expected*' "$dcf2ccf" -n "$id" device.dcf
done
expect 'ccfread alone' 2 '' 'Usage: ccfread *' "$ccfread"
expect 'ccfread -h' 0 'Usage: ccfread *' '' "$ccfread" -h
expect 'ccfread --version' 0 'ccfread [0-9]*.[0-9]*' '' "$ccfread" --version
expect 'ccfread with two' 2 '' '*one file expected*' "$ccfread" device.ccf device.ccf
expect 'ccfread --foo' 2 '' '*' "$ccfread" --foo device.ccf
if [ -e /dev/full ]; then
    "$ccfread" device.ccf >/dev/full 2>/dev/null
    same 'ccfread to a full disk' 2 $?
fi

echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
