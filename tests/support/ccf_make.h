/* Making a concise DCF of the text of a DCF, for tables: the writes and messages of it. */
#ifndef TEST_SUPPORT_CCF_MAKE_H
#define TEST_SUPPORT_CCF_MAKE_H

#include "dcf/dcf.h"
#include "support/messages.h"

/* Only what the writes depend on: what the reader misses in such a file is not looked at here. */
#define ENTRY(name, type, access, values)                                                          \
    "[" name "]\nParameterName=x\nDataType=" type "\nAccessType=" access "\n" values
#define U8(name, values)  ENTRY(name, "5", "rw", values)
#define U16(name, values) ENTRY(name, "6", "rw", values)
#define U32(name, values) ENTRY(name, "7", "rw", values)
#define RECORD(name)      "[" name "]\nParameterName=x\nObjectType=9\n"
#define P(value)          "ParameterValue=" value "\n"
#define D(value)          "DefaultValue=" value "\n"

#define RPDO(cob_id) RECORD("1400") U32("1400sub1", cob_id)
#define MAPPING(count, first, second)                                                              \
    RECORD("1600") U8("1600sub0", count) U32("1600sub1", first) U32("1600sub2", second)

struct ccf_make {
    const char *name;
    const char *dcf;
    const char *expected; /* "index:sub bytes", a line each; NULL: refused */
    const char *messages;
};

extern struct messages ccf_make_messages; /* of the last one that was made or read */

void ccf_make_check(const struct ccf_make *make, const struct dcf_ccf_options *options);
/* A file without an error. */
void ccf_make_parse(const char *file, struct dcf *ret_dcf);
/* As in 'expected', until the next one. */
const char *ccf_make_format(const struct ccf *ccf);

#endif
