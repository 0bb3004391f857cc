/*
 * The binary interface, frozen: values, sizes, offsets and prototypes of the public headers, by
 * abi.c (manager) and abi_slave.c. They are compiled, not run; with 64 and with 32 bits. A line
 * there changes only together with the SONAME; only a structure whose first
 * member is its size may grow at its end without.
 */
#ifndef TESTS_ABI_H
#define TESTS_ABI_H

#include <limits.h>
#include <stddef.h>

#define VALUE(name, value) _Static_assert((name) == (value), #name)
#define BITS(on_64, on_32) (sizeof(long) == 8 ? (on_64) : (on_32))
#define SIZE(type, on_64, on_32)                                                                   \
    _Static_assert(sizeof(type) == BITS(on_64, on_32), "size of " #type)
#define OFFSET(type, member, on_64, on_32)                                                         \
    _Static_assert(offsetof(type, member) == BITS(on_64, on_32), #type "." #member)
#define FUNCTION(name, result, ...)                                                                \
    _Static_assert(_Generic(&name, result(*)(__VA_ARGS__) : 1, default : 0), #name)

_Static_assert(CHAR_BIT == 8 && sizeof(int) == 4 && sizeof(void *) == sizeof(long), "data model");

#endif
