/*
 * dcf_values NODE FILE...: what our reader reads from EDS and DCF files, for comparison with other
 * readers. A line "= FILE", then one for each entry: index, sub-index, data type, access, the
 * default value's bytes in hexadecimal for this node-ID; "-" where there is none. Of a file that is
 * refused there is the first error, on stderr.
 */
#include "api/file.h"
#include "dcf/dcf_build.h"

#include <stdio.h>
#include <stdlib.h>

static bool print_default(const struct dcf_value *value, uint8_t node_id)
{
    uint8_t *bytes = malloc(value->size + 1);
    uint32_t size;

    if (!bytes)
        return false;
    size = dcf_value(value, node_id, bytes);
    for (uint32_t i = 0; i < size; i++)
        printf("%02x", bytes[i]);
    puts(value->given ? "" : "-");
    free(bytes);
    return true;
}

static bool print_entry(const struct dcf_entry *entry, uint8_t node_id)
{
    printf("%04X %02X %02X %s ", entry->index, entry->sub, entry->type,
           dcf_access_text(entry->access));
    return print_default(&entry->initial, node_id);
}

static bool print_file(const char *path, uint8_t node_id)
{
    struct co_report report = { .file = path };
    bool printed = true;
    char *text;
    size_t size;
    struct dcf dcf;

    if (file_read(path, &text, &size) != CO_OK)
        return false;
    printf("= %s\n", path);
    if (dcf_parse(text, size, &report, &dcf) != CO_OK)
        fprintf(stderr, "%s\n", report.first_error);
    for (size_t i = 0; i < dcf.count && printed; i++)
        printed = print_entry(&dcf.entries[i], node_id);
    dcf_done(&dcf);
    free(text);
    return printed;
}

int main(int argc, char **argv)
{
    uint8_t node_id = (uint8_t)(argc > 1 ? atoi(argv[1]) : 0);

    for (int i = 2; i < argc; i++) {
        if (!print_file(argv[i], node_id))
            return 1;
    }
    return fflush(stdout) == 0 ? 0 : 1;
}
