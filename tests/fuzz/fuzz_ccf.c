/* Concise DCF: what is accepted reads back to exactly its bytes. */
#include "dcf/ccf.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_copy(const struct ccf *ccf, const uint8_t *data, size_t size)
{
    struct ccf copy;
    struct ccf_reader reader;
    struct ccf_entry entry;

    ccf_init(&copy);
    ccf_reader_init(&reader, ccf);
    while (ccf_read(&reader, &entry)) {
        if (ccf_append(&copy, entry.index, entry.sub, entry.value, entry.size) != CO_OK)
            abort();
    }
    if (ccf_count(ccf) > 0 && (copy.size != size || memcmp(copy.bytes, data, size) != 0))
        abort();
    ccf_done(&copy);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct co_report report = { .file = "fuzz" };
    struct ccf ccf;

    if (ccf_parse(data, size, &report, &ccf) != CO_OK) {
        if (report.errors == 0)
            abort();
        return 0;
    }
    check_copy(&ccf, data, size);
    ccf_done(&ccf);
    return 0;
}
