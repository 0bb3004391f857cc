#include "base/error.h"

#include <stddef.h>

static const char *const texts[] = {
    [-CO_OK] = "no error",
    [-CO_ERR_ARG] = "argument out of range",
    [-CO_ERR_MEMORY] = "out of memory",
    [-CO_ERR_AGAIN] = "nothing there at the moment",
    [-CO_ERR_TIMEOUT] = "time-out",
    [-CO_ERR_IO] = "the operating system refused",
    [-CO_ERR_NO_BUS] = "no such interface",
    [-CO_ERR_DOWN] = "the interface is down",
    [-CO_ERR_PERMISSION] = "permission denied",
    [-CO_ERR_FORMAT] = "malformed input",
    [-CO_ERR_VALUE] = "invalid value",
    [-CO_ERR_EXISTS] = "already there",
    [-CO_ERR_NOT_FOUND] = "not found",
    [-CO_ERR_STATE] = "not possible in this state",
    [-CO_ERR_HELD] = "the bus is held by a stopped process",
    [-CO_ERR_BITRATE] = "the interface runs at another bit rate",
    [-CO_ERR_INHIBITED] = "waits for the end of the inhibit time",
    [-CO_ERR_UNSUPPORTED] = "not supported here",
};

const char *co_err_text(enum co_err err)
{
    size_t number = 0u - (unsigned)err;

    return number < sizeof texts / sizeof texts[0] ? texts[number] : "unknown error";
}
