#include "base/error.h"

const char *co_err_text(enum co_err err)
{
    switch (err) {
    case CO_OK: return "no error";
    case CO_ERR_ARG: return "argument out of range";
    case CO_ERR_MEMORY: return "out of memory";
    case CO_ERR_AGAIN: return "nothing there at the moment";
    case CO_ERR_TIMEOUT: return "time-out";
    case CO_ERR_IO: return "the operating system refused";
    case CO_ERR_NO_BUS: return "no such interface";
    case CO_ERR_DOWN: return "the interface is down";
    case CO_ERR_PERMISSION: return "permission denied";
    case CO_ERR_FORMAT: return "malformed input";
    case CO_ERR_VALUE: return "invalid value";
    case CO_ERR_EXISTS: return "already there";
    case CO_ERR_NOT_FOUND: return "not found";
    case CO_ERR_STATE: return "not possible in this state";
    case CO_ERR_HELD: return "the bus is held by a stopped process";
    case CO_ERR_BITRATE: return "the interface runs at another bit rate";
    }
    return "unknown error";
}
