#include "support/guarded.h"

#include "support/guard.h"

enum co_err guarded_dcf_parse(const char *text, size_t size, struct co_report *report,
                              struct dcf *ret_dcf)
{
    struct guard guard;
    enum co_err err;

    guard_init(&guard, text, size);
    err = dcf_parse(guard.bytes, size, report, ret_dcf);
    guard_done(&guard);
    return err;
}

enum co_err guarded_ccf_parse(const uint8_t *bytes, size_t size, struct co_report *report,
                              struct ccf *ret_ccf)
{
    struct guard guard;
    enum co_err err;

    guard_init(&guard, bytes, size);
    err = ccf_parse((const uint8_t *)guard.bytes, size, report, ret_ccf);
    guard_done(&guard);
    return err;
}

enum co_err guarded_config_parse(const char *text, size_t size, struct co_report *report,
                                 struct network_config **ret_networks, size_t *ret_count)
{
    struct guard guard;
    enum co_err err;

    guard_init(&guard, text, size);
    err = network_config_parse(guard.bytes, size, report, ret_networks, ret_count);
    guard_done(&guard);
    return err;
}
