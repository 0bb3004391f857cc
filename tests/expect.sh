# For tests of tools from outside: a folder of their own to be in, and what a command is to print.
# The test ends with expect_end.
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

expect_end()
{
    echo "$passed passed, $failed failed"
    [ $failed -eq 0 ]
}
