#include "support/ccf_make.h"

#include "support/guarded.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

struct messages ccf_make_messages;
static char text[4000];

const char *ccf_make_format(const struct ccf *ccf)
{
    struct ccf_reader reader;
    struct ccf_entry entry;
    size_t used = 0;

    text[0] = '\0';
    ccf_reader_init(&reader, ccf);
    while (ccf_read(&reader, &entry)) {
        used += (size_t)sprintf(text + used, "%04X:%02X ", entry.index, entry.sub);
        for (uint32_t i = 0; i < entry.size; i++)
            used += (size_t)sprintf(text + used, "%02X", entry.value[i]);
        used += (size_t)sprintf(text + used, "\n");
    }
    return text;
}

void ccf_make_parse(const char *file, struct dcf *ret_dcf)
{
    messages_init(&ccf_make_messages);
    ck_assert_msg(guarded_dcf_parse(file, strlen(file), &ccf_make_messages.report, ret_dcf) ==
                      CO_OK,
                  "%s", ccf_make_messages.text);
    messages_init(&ccf_make_messages);
}

void ccf_make_check(const struct ccf_make *make, const struct dcf_ccf_options *options)
{
    struct dcf dcf;
    struct ccf ccf = { .size = 77 };
    enum co_err err;

    ccf_make_parse(make->dcf, &dcf);
    err = dcf_make_ccf(&dcf, options, &ccf_make_messages.report, &ccf);
    ck_assert_msg(strcmp(ccf_make_messages.text, make->messages) == 0, "%s: messages:\n%s",
                  make->name, ccf_make_messages.text);
    if (make->expected) {
        ck_assert_int_eq(err, CO_OK);
        ck_assert_msg(strcmp(ccf_make_format(&ccf), make->expected) == 0, "%s: made:\n%s",
                      make->name, text);
        ccf_done(&ccf);
    } else {
        ck_assert_int_eq(err, CO_ERR_VALUE);
        ck_assert_uint_eq(ccf.size, 77);
    }
    dcf_done(&dcf);
}
