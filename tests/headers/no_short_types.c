/*
 * Headers beside another library's UINT16 and friends. It is compiled, not run.
 */
#define MCANOPEN_NO_SHORT_TYPES
struct foreign {
    int x;
};
typedef struct foreign UINT8, UINT16, UINT32, UINT64, INT8, INT16, INT32, INT64, VOID;

#include "mcanopen.h"
#include "paraInfo.h"
#include "scanopen.h"

UINT16 *foreign_pointer(UINT16 *pointer);

UINT16 *foreign_pointer(UINT16 *pointer)
{
    return pointer;
}
