/*
 * bench_dcf FILE: reads an EDS or DCF file and checks it, as tools do, for callgrind. Prints how
 * many messages there are, and the messages to stderr.
 */
#include "dcf/dcf.h"
#include "dcf/dcf_lint.h"

#include <stdio.h>
#include <stdlib.h>

static void print(void *context, const struct co_message *message)
{
    (void)context;
    fprintf(stderr, "%s\n", message->text);
}

static char *read_file(const char *path, size_t *ret_size)
{
    FILE *stream = fopen(path, "rb");
    char *bytes = NULL;
    long size;

    if (!stream)
        return NULL;
    if (fseek(stream, 0, SEEK_END) == 0 && (size = ftell(stream)) >= 0) {
        rewind(stream);
        bytes = malloc((size_t)size + 1);
        *ret_size = bytes ? fread(bytes, 1, (size_t)size, stream) : 0;
    }
    fclose(stream);
    return bytes;
}

int main(int argc, char **argv)
{
    struct co_report report = { .file = argc > 1 ? argv[1] : "", .sink = print };
    size_t size;
    char *bytes = read_file(report.file, &size);
    struct dcf dcf;

    if (!bytes) {
        perror(report.file);
        return 1;
    }
    if (dcf_parse(bytes, size, &report, &dcf) == CO_OK) {
        if (dcf_lint(&dcf, &report) != CO_OK)
            perror(report.file);
        dcf_done(&dcf);
    }
    free(bytes);
    printf("{\"messages\": %u}\n", report.errors + report.warnings);
    return 0;
}
