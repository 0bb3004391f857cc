/*
 * The readers of files on a copy that ends where memory ends, and that is gone when they return:
 * reading one byte too many, or later, is a crash.
 */
#ifndef TEST_SUPPORT_GUARDED_H
#define TEST_SUPPORT_GUARDED_H

#include "dcf/dcf.h"
#include "manager/network_config.h"

enum co_err guarded_dcf_parse(const char *text, size_t size, struct co_report *report,
                              struct dcf *ret_dcf);
enum co_err guarded_ccf_parse(const uint8_t *bytes, size_t size, struct co_report *report,
                              struct ccf *ret_ccf);
enum co_err guarded_config_parse(const char *text, size_t size, struct co_report *report,
                                 struct network_config **ret_networks, size_t *ret_count);

#endif
