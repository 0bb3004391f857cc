#!/usr/bin/env python3
"""Writes the switches of the disabling run: C functions in front of those of the public headers.

    make_switches.py INCLUDE OUTPUT

The linker leads all calls of canOpenX to __wrap_canOpenX (--wrap), which is made here. It calls the
library's canOpenX, unless the environment's MCANOPEN_DISABLE is "canOpenX": then it does nothing
and returns "not implemented". The same for mcanOpenX.
"""
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import contract  # noqa: E402, found there

HEAD = """/* Made by tests/disabling/make_switches.py. */
#include "mcanopen.h"
#include "scanopen.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#undef canOpenExtendDictionary

static bool disabled(const char *function)
{
    const char *name = getenv("MCANOPEN_DISABLE");

    return name && strcmp(name, function) == 0;
}
"""
SWITCH = """
{result}__real_{name}({parameters});
{result}__wrap_{name}({parameters});

{result}__wrap_{name}({parameters})
{{
    if (disabled("{name}"))
        return{value};
    {call}__real_{name}({arguments});
}}
"""
HEADERS = ("scanopen.h", "mcanopen.h")


def not_implemented(function):
    """What it returns instead of a result."""
    if function.result == "void":
        return ""
    if function.result.endswith("*"):
        return ' ""'
    return " MCAL_UNSUPPORTED" if function.name.startswith("mcan") else " SCANOPEN_NOT_IMPLEMENTED"


def switch(function):
    names = (re.search(r"(\w+)$", p).group(1) for p in function.parameters)
    return SWITCH.format(result=function.result + (" " if function.result[-1] != "*" else ""),
                         name=function.name, parameters=", ".join(function.parameters),
                         value=not_implemented(function),
                         call="" if function.result == "void" else "return ",
                         arguments=", ".join(n for n in names if n != "void"))


def main(arguments):
    if len(arguments) != 2:
        print(__doc__.strip())
        return 2
    texts = ((Path(arguments[0]) / name).read_text(encoding="utf-8") for name in HEADERS)
    switches = [switch(f) for text in texts for f in contract.functions_of(text)]
    Path(arguments[1]).write_text(HEAD + "".join(switches), encoding="utf-8")
    return 0 if switches else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
