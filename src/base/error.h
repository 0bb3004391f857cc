/*
 * Errors of internal functions: 0 or one of these negative values. SDO abort codes are another type
 * (od/abort.h) and never mixed with them; api/ maps these to the codes of the public headers.
 */
#ifndef CO_BASE_ERROR_H
#define CO_BASE_ERROR_H

enum co_err {
    CO_OK = 0,
    CO_ERR_ARG = -1,     /* an argument is outside its range */
    CO_ERR_MEMORY = -2,  /* no memory */
    CO_ERR_AGAIN = -3,   /* nothing there, or no room, at the moment */
    CO_ERR_TIMEOUT = -4, /* the deadline has passed */
    CO_ERR_IO = -5,      /* the operating system refused; errno tells */
    CO_ERR_NO_BUS = -6,  /* no such interface, or it went away */
    CO_ERR_DOWN = -7,    /* the interface is there but down */
    CO_ERR_PERMISSION = -8,
    CO_ERR_FORMAT = -9,  /* the input is malformed; a message tells */
    CO_ERR_VALUE = -10,  /* a value in well-formed input is not valid; a message tells */
    CO_ERR_EXISTS = -11, /* already there */
    CO_ERR_NOT_FOUND = -12,
    CO_ERR_STATE = -13,      /* not possible in this state */
    CO_ERR_HELD = -14,       /* a stopped process holds the virtual bus */
    CO_ERR_BITRATE = -15,    /* the interface runs at another bit rate */
    CO_ERR_INHIBITED = -16,  /* it is kept, and goes out when the inhibit time ends */
    CO_ERR_UNSUPPORTED = -17 /* this bus or this kernel has no such thing */
};

const char *co_err_text(enum co_err err);

#endif
