/* What there is to tell about the files of nodes themselves, as dcftest does. */
#include "audit.h"

#include "api/error_map.h"
#include "api/file.h"
#include "api/load.h"
#include "dcf/dcf_compare.h"
#include "dcf/dcf_lint.h"

#include <stdlib.h>
#include <string.h>

static bool was_told(const struct audit_node *self)
{
    const struct audit *audit = self->network->audit;

    for (size_t i = 0; i < audit->count; i++) {
        const struct audit_network *network = &audit->networks[i];

        for (size_t k = 0; k < network->node_count; k++) {
            const struct audit_node *node = &network->nodes[k];

            if (node == self)
                return false;
            if (node->described && strcmp(node->description_file, self->description_file) == 0)
                return true;
        }
    }
    return false;
}

static bool tell(const struct audit_node *self, const char *text, size_t size)
{
    struct co_report *report = self->network->report;
    struct dcf dcf;
    enum co_err err;

    report->file = self->description_file;
    err = dcf_parse(text, size, report, &dcf);
    if (err != CO_OK) /* it has changed meanwhile */
        return err != CO_ERR_MEMORY;
    err = dcf_lint(&dcf, report);
    dcf_done(&dcf);
    return err != CO_ERR_MEMORY;
}

bool audit_tell_file(const struct audit_node *self)
{
    char *text = NULL;
    size_t size;
    bool good;

    if (!self->described || was_told(self))
        return true;
    if (file_read(self->description_file, &text, &size) != CO_OK)
        return true;
    good = tell(self, text, size);
    free(text);
    return good;
}

bool audit_compare_file(const struct audit_node *self, const char *eds_file)
{
    struct dcf eds;
    int result = load_dcf(eds_file, self->network->report, &eds);

    if (result != MCANOPEN_OK)
        return result != CANOPEN_DCF_OUT_OF_MEMORY;
    self->network->report->file = self->description_file;
    dcf_compare(&self->description, &eds, self->network->report);
    dcf_done(&eds);
    return true;
}
