#!/bin/sh
# ccfread from outside: sh test_tools_ccfread.sh CCFREAD
set -u

ccfread=$1
data=$(cd "$(dirname "$0")" && pwd)/data/ccfread
. "$(dirname "$0")/expect.sh"

# bytes HEX...: as they are
bytes()
{
    for byte in $(echo "$*" | sed 's/ //g; s/../& /g'); do
        # shellcheck disable=SC2059 # an octal escape
        printf "\\$(printf %03o "0x$byte")"
    done
}

# golden NAME CODE COMMAND...: stdout and behind it stderr are what is in data/ccfread/NAME.txt
golden()
{
    name=$1
    code=$2
    shift 2
    "$@" >out 2>err </dev/null
    status=$?
    cat err >>out
    wanted=$data/$(echo "$name" | tr -cs '[:alnum:]\n' -).txt
    if [ $status -eq "$code" ] && diff "$wanted" out >differences; then
        passed=$((passed + 1))
        return
    fi
    failed=$((failed + 1))
    echo "FAILED: $name: exit code $status, expected $code"
    cat differences
}

object() # INDEX NAME TYPE ACCESS
{
    printf '[%s]\nParameterName=%s\nDataType=%s\nAccessType=%s\n' "$@"
}

sub_objects() # INDEX NAME NUMBER
{
    printf '[%s]\nParameterName=%s\nObjectType=9\nSubNumber=%s\n' "$@"
}

{
    printf '[FileInfo]\nFileName=x\n'
    object 1005 'COB-ID SYNC' 7 rw
    object 1017 'Producer heartbeat time' 6 rw
    object 1018 Identity 7 ro
    sub_objects 1400 'RPDO 1' 2
    object 1400sub0 'Highest sub-index' 5 const
    object 1400sub1 'COB-ID used by RPDO' 7 rw
    object 2000 switch 1 rw
    object 2001 'an INTEGER8' 2 rw
    object 2002 'an INTEGER24' 0x10 rw
    object 2003 'an INTEGER64' 0x15 rw
    object 2004 'an UNSIGNED64' 0x1B rw
    object 2005 'a REAL32' 8 rw
    object 2006 'a REAL64' 0x11 rw
    object 2007 text 9 rw
    object 2008 octets 0x0A rw
    object 2009 'wide text' 0x0B rw
    object 200A 'a time' 0x0C rw
    object 200B 'a difference' 0x0D rw
    printf '[200C]\nParameterName=a domain\nObjectType=2\nDataType=0xF\nAccessType=rw\n'
    printf '[200D]\nParameterName=ten\033[31mred\nDataType=5\nAccessType=rw\n'
} >device.eds

# ---- without EDS: by size ------------------------------------------------------------------------

bytes 0D000000 17100002000000 F401 05100004000000 80000040 12100004000000 00010080 \
    14100004000000 85000080 16100104000000 D0077F00 20100104000000 B73A0000 \
    20100204000000 4B6F1101 00140104000000 050200A0 00180104000000 85010040 \
    001A0104000000 10014160 00200000000000 10100104000000 73617665 \
    00210012000000 000102030405060708090A0B0C0D0E0F1011 >known.ccf
golden 'objects of CiA 301' 0 "$ccfread" known.ccf
bytes 00000000 >nothing.ccf
golden 'nothing' 0 "$ccfread" nothing.ccf

# ---- with EDS: by type ---------------------------------------------------------------------------

bytes 12000000 00200001000000 01 00200001000000 07 01200001000000 FB 02200003000000 FFFF7F \
    03200008000000 FEFFFFFFFFFFFFFF 04200008000000 FEFFFFFFFFFFFFFF 05200004000000 CDCCCC3D \
    05200004000000 0000C07F 06200008000000 9A9999999999B93F 07200008000000 61225C0A0941E900 \
    08200003000000 414200 09200005000000 4100E92041 0A200006000000 CB6F1101 B73A \
    0B200006000000 01000000 0200 0C200014000000 7F454C46020101000000000000000000AABBCCDD \
    07200000000000 00140104000000 05020080 0D200001000000 0A >types.ccf
golden 'types of the EDS' 0 "$ccfread" --eds device.eds types.ccf

bytes 04000000 17100004000000 F4010000 18100004000000 01000000 00300001000000 01 \
    00140101000000 01 >wrong.ccf
golden 'what the device will refuse' 0 "$ccfread" -e device.eds wrong.ccf

# ---- damage --------------------------------------------------------------------------------------

bytes 02000000 17100002000000 F401 16100104000000 D007 >short.ccf
golden 'a value that ends too early' 1 "$ccfread" short.ccf
bytes 03000000 17100002000000 F401 16100104000000 D0077F00 >count.ccf
golden 'a count that is too high' 1 "$ccfread" count.ccf
bytes 01000000 17100002000000 F401 16100104000000 D0077F00 00200000000000 >more.ccf
golden 'a count that is too low' 1 "$ccfread" more.ccf
bytes 01000000 17100002000000 F401 1610010400000044 >behind.ccf
golden 'bytes behind the end' 1 "$ccfread" behind.ccf
bytes FFFFFFFF 17100002000000 F401 16 >huge.ccf
golden 'a huge count' 1 "$ccfread" huge.ccf
bytes 01000000 171000FFFFFFFF F401 >size.ccf
golden 'a huge size' 1 "$ccfread" size.ccf
bytes 0100 >tiny.ccf
golden 'less than a count' 1 "$ccfread" tiny.ccf
: >empty.ccf
expect 'an empty file' 1 'empty.ccf: 0 entries, 0 bytes*' \
    'empty.ccf: error: a concise DCF begins with a count of 4 bytes, the file has 0' \
    "$ccfread" empty.ccf

# ---- several files, standard input ---------------------------------------------------------------

bytes 01000000 00200001000000 07 >one.ccf
golden 'several files, the worst exit code' 2 "$ccfread" one.ccf none.ccf tiny.ccf one.ccf
same 'standard input' 'stdin: 1 entry, 12 bytes' "$("$ccfread" - <one.ccf | head -n 1)"
same 'a pipe' 'stdin: 1 entry, 12 bytes' "$(cat one.ccf | "$ccfread" - | head -n 1)"
expect 'a folder' 2 '' 'ccfread: .: a folder, expected a file' "$ccfread" .
truncate -s 2G large.ccf
expect 'two gigabytes' 2 '' 'ccfread: large.ccf: larger than 64 MiB' "$ccfread" large.ccf
rm large.ccf
if [ -e /dev/full ]; then
    for option in --json --diff ''; do
        # shellcheck disable=SC2086 # none is none
        "$ccfread" $option known.ccf one.ccf >/dev/full 2>err
        same "a full disk $option" '2 ccfread: standard output: No space left on device' \
            "$? $(cat err)"
    done
fi

# ---- JSON ----------------------------------------------------------------------------------------

golden 'JSON' 1 "$ccfread" --json --eds device.eds wrong.ccf short.ccf
"$ccfread" --json -e device.eds types.ccf | sed -n 's/.*"value":\(.*\),"index.*/\1/p' >values
cat >wanted <<'END'
true
7
-5
8388607
-2
"18446744073709551614"
0.10000000149011612
0.10000000000000001
"a\"\\\n\tA\u00E9\u0000"
"2025-02-25 04:58:39.947"
"2 days 00:00:00.001"
""
2147484165
10
END
expect 'JSON values' 0 '' '' diff wanted values
bytes 07000000 09200006000000 4100E900AC20 09200000000000 09200001000000 41 \
    09200004000000 3DD800DE 09200002000000 00D8 09200002000000 FFDF 09200002000000 FFFF >wide.ccf
"$ccfread" --json -e device.eds wide.ccf | sed -n 's/.*"data":"[0-9A-F]*",*\(.*\)"index.*/\1/p' \
    >values
same 'wide text in JSON' '"value":"A\u00E9\u20AC", "value":"",     "value":"\uFFFF",' \
    "$(tr '\n' ' ' <values | sed 's/ $//')"
for day in 0:1984-01-01 3B:1984-02-29 3C:1984-03-01 16D:1984-12-31 16E:1985-01-01 4D96:2038-05-19 \
    A61B:2100-06-04 FFFF:2163-06-06; do
    number=$(printf %08X "0x${day%:*}" | sed 's/\(..\)\(..\)\(..\)\(..\)/\4\3\2\1/')
    bytes "01000000 20100104000000 $number" >day.ccf
    same "day ${day%:*}h" "${day#*:}" "$("$ccfread" day.ccf | sed -n 's/.*: \(....-\)/\1/p')"
done
for files in 'one.ccf more.ccf nothing.ccf' none.ccf '--diff known.ccf types.ccf' \
    '--diff one.ccf one.ccf'; do
    # shellcheck disable=SC2086 # words
    "$ccfread" --json $files >json 2>err
    expect "JSON that others read: $files" 0 '' '' python3 -c 'import json; json.load(open("json"))'
done

# ---- differences ---------------------------------------------------------------------------------

bytes 06000000 05100004000000 80000000 00140104000000 05020080 00200001000000 07 \
    00140104000000 05020000 17100002000000 F401 01200001000000 01 >a.ccf
bytes 06000000 17100002000000 E803 05100004000000 80000000 00200001000000 07 \
    00140104000000 05020000 01200001000000 01 09200002000000 4100 >b.ccf
golden 'differences' 1 "$ccfread" --diff a.ccf b.ccf
golden 'differences with names' 1 "$ccfread" --diff -e device.eds b.ccf a.ccf
golden 'differences in JSON' 1 "$ccfread" --diff --json -e device.eds a.ccf b.ccf
expect 'no difference' 0 '' '' "$ccfread" --diff a.ccf a.ccf
expect 'no difference in JSON' 0 '[[]]' '' "$ccfread" --diff --json a.ccf a.ccf
expect 'two that have nothing' 0 '' '' "$ccfread" --diff nothing.ccf nothing.ccf

# Entries 2001h..2008h in this order, each of one byte.
ordered()
{
    bytes 08000000
    for number in "$@"; do
        bytes "0${number}20000100000001"
    done
}
ordered 1 2 3 4 5 6 7 8 >ordered.ccf
moved_to() # ORDER...: what has moved
{
    # shellcheck disable=SC2086 # words
    ordered $1 >other.ccf
    "$ccfread" --diff ordered.ccf other.ccf | sed -n 's/^200\(.\).* moved .*/\1/p' | tr '\n' ' '
}
same 'one moved forward' '8 ' "$(moved_to '8 1 2 3 4 5 6 7')"
same 'one moved back' '1 ' "$(moved_to '2 3 4 5 6 7 8 1')"
same 'two exchanged' 1 "$(moved_to '2 1 3 4 5 6 7 8' | wc -w | tr -d ' ')"
same 'all the other way round' 7 "$(moved_to '8 7 6 5 4 3 2 1' | wc -w | tr -d ' ')"
same 'a group moved' '6 7 8 ' "$(moved_to '6 7 8 1 2 3 4 5')"

bytes 01000000 0720000A000000 41414141414141414141 >text-a.ccf
bytes 01000000 0720000B000000 4141414141414141414241 >text-b.ccf
expect 'long values' 1 '*
2007h:00      changed  "AAAAAAAAAA" (10 bytes) -> "AAAAAAAAABA" (11 bytes), from byte 9 on' '' \
    "$ccfread" --diff text-a.ccf text-b.ccf
golden 'a damaged file is compared as far as it goes' 1 "$ccfread" --diff short.ccf count.ccf
expect 'the damage alone' 1 '' '*' "$ccfread" --diff count.ccf count.ccf
expect 'a file that is gone' 2 '' 'ccfread: none.ccf: no such file' "$ccfread" --diff a.ccf none.ccf

# ---- usage ---------------------------------------------------------------------------------------

expect 'alone' 2 '' 'Usage: ccfread *' "$ccfread"
expect '-h' 0 'Usage: ccfread *' '' "$ccfread" -h
expect '--version' 0 'ccfread [0-9]*.[0-9]*' '' "$ccfread" --version
expect 'no file' 2 '' '*a file expected*' "$ccfread" --json
expect '--diff with one' 2 '' '*two files expected*' "$ccfread" --diff a.ccf
expect '--diff with three' 2 '' '*two files expected*' "$ccfread" --diff a.ccf a.ccf a.ccf
expect '--foo' 2 '' '*unrecognized option*' "$ccfread" --foo a.ccf
expect 'no EDS' 2 '' 'ccfread: none.eds: no such file' "$ccfread" -e none.eds a.ccf
expect 'a CCF as EDS' 2 '' 'a.ccf: error: *' "$ccfread" -e a.ccf a.ccf

expect_end
