#!/usr/bin/env python3
"""Writes the switches of the disabling run: C functions in front of those of scanopen.h.

    make_switches.py INCLUDE OUTPUT

The linker leads all calls of canOpenX to __wrap_canOpenX (--wrap), which is made here. It calls the
library's canOpenX, unless the environment's MCANOPEN_DISABLE is "canOpenX": then it does nothing
and returns "not implemented".
"""
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import contract  # noqa: E402, found there

HEAD = """/* Made by tests/disabling/make_switches.py. */
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
VALUE = """
{result} __real_{name}({parameters});
{result} __wrap_{name}({parameters});

{result} __wrap_{name}({parameters})
{{
    if (disabled("{name}"))
        return SCANOPEN_NOT_IMPLEMENTED;
    return __real_{name}({arguments});
}}
"""
NO_VALUE = VALUE.replace("return SCANOPEN_NOT_IMPLEMENTED", "return").replace(
    "    return __real_", "    __real_")


def switch(function):
    arguments = (re.search(r"(\w+)$", p).group(1) for p in function.parameters)
    form = NO_VALUE if function.result == "void" else VALUE
    return form.format(result=function.result, name=function.name,
                       parameters=", ".join(function.parameters), arguments=", ".join(arguments))


def main(arguments):
    if len(arguments) != 2:
        print(__doc__.strip())
        return 2
    text = (Path(arguments[0]) / "scanopen.h").read_text(encoding="utf-8")
    switches = [switch(f) for f in contract.functions_of(text)]
    Path(arguments[1]).write_text(HEAD + "".join(switches), encoding="utf-8")
    return 0 if switches else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
