/* EDS and DCF files: what is accepted gives an ordered description and a whole concise DCF. */
#include "dcf/dcf.h"
#include "dcf/dcf_compare.h"
#include "dcf/dcf_lint.h"

#include <stdlib.h>
#include <string.h>

#define NODE_ID 5

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* "/a/../b/" for "a\\..\\b": whether ".." is a part of it can be seen. */
static bool goes_up(const char *name)
{
    char *path = malloc(strlen(name) + 3);
    bool up;

    if (!path)
        abort();
    path[0] = '/';
    strcpy(path + 1, name);
    strcat(path, "/");
    for (char *c = path; *c; c++)
        *c = *c == '\\' ? '/' : *c;
    up = path[1] == '/' || strstr(path, "/../");
    free(path);
    return up;
}

static enum co_err give_file(void *context, const char *name, uint8_t **ret_bytes, size_t *ret_size)
{
    (void)context;
    if (goes_up(name))
        abort();
    *ret_size = strlen(name);
    *ret_bytes = (uint8_t *)strdup(name);
    return *ret_bytes ? CO_OK : CO_ERR_MEMORY;
}

static void check_order(const struct dcf *dcf)
{
    for (size_t i = 1; i < dcf->count; i++) {
        const struct dcf_entry *a = &dcf->entries[i - 1], *b = &dcf->entries[i];

        if (a->index > b->index || (a->index == b->index && a->sub >= b->sub))
            abort();
        if (dcf_find(dcf, b->index, b->sub) != b)
            abort();
    }
}

static void check_ccf(const struct dcf *dcf, bool old_style, bool all)
{
    struct dcf_ccf_options options = {
        .node_id = NODE_ID, .old_style = old_style, .all = all, .read_file = give_file
    };
    struct co_report report = { .file = "fuzz" };
    struct ccf ccf, again;

    if (dcf_make_ccf(dcf, &options, &report, &ccf) != CO_OK) {
        if (report.errors == 0)
            abort();
        return;
    }
    if (ccf_parse(ccf.bytes, ccf.size, &report, &again) != CO_OK)
        abort();
    ccf_done(&again);
    ccf_done(&ccf);
}

static void check_od(const struct dcf *dcf)
{
    struct co_report report = { .file = "fuzz" };
    struct od od;

    od_init(&od);
    if (dcf_make_od(dcf, NODE_ID, &report, &od) != CO_OK)
        abort();
    od_done(&od);
}

/* Nothing of it is an error. */
static void check_lint(const struct dcf *dcf)
{
    struct co_report report = { .file = "fuzz" };

    if (dcf_lint(dcf, &report) != CO_OK || report.errors > 0)
        abort();
}

/* A file does not differ from itself; but it may name another one as its EDS. */
static void check_compare(const struct dcf *dcf)
{
    struct co_report report = { .file = "fuzz" };

    dcf_compare(dcf, dcf, &report);
    if (report.errors > 0 || report.warnings > (dcf->last_eds ? 1u : 0u))
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct co_report report = { .file = "fuzz" };
    struct dcf dcf;

    if (dcf_parse((const char *)data, size, &report, &dcf) != CO_OK) {
        if (report.errors == 0 || dcf.count != 0)
            abort();
        return 0;
    }
    check_order(&dcf);
    check_ccf(&dcf, false, false);
    check_ccf(&dcf, true, false);
    check_ccf(&dcf, false, true);
    check_od(&dcf);
    check_lint(&dcf);
    check_compare(&dcf);
    dcf_done(&dcf);
    return 0;
}
