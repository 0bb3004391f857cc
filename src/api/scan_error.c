/* Errors of the application: canOpenSetError, canOpenResetError, which are still to come. */
#include "scanopen.h"

int canOpenSetError(HNODE Hnode, unsigned short ErrorCode, unsigned short ErrorInformation,
                    unsigned short ErrorRegister, const unsigned char *ErrorField)
{
    (void)Hnode;
    (void)ErrorCode;
    (void)ErrorInformation;
    (void)ErrorRegister;
    (void)ErrorField;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenResetError(HNODE Hnode, unsigned short ErrorRegister, const unsigned char *ErrorField)
{
    (void)Hnode;
    (void)ErrorRegister;
    (void)ErrorField;
    return SCANOPEN_NOT_IMPLEMENTED;
}
