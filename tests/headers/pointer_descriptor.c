/*
 * A descriptor as the manual prints it, an array of pointers: C11 programs compile, with the
 * warning that the compiler has for that. It is compiled, not run.
 */
#include "scanopen.h"

int pointer_descriptor(HNODE node);

int pointer_descriptor(HNODE node)
{
    const char *simple[] = { TYP_INT32, 0 };
    const char *const constant[] = { TYP_INT32, 0 };

    return canOpenExtendDictionary(node, 0x2000, 0, OBJ_VAR, simple) +
           canOpenExtendDictionary(node, 0x2001, 0, OBJ_VAR, constant);
}
