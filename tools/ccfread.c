/* ccfread: what is in a concise DCF, one line for each entry. */
#include "api/file.h"
#include "base/bytes.h"
#include "common_file.h"
#include "common_tool.h"
#include "dcf/ccf.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

#define EXIT_TROUBLE 2
#define NUMBER_SIZE  8u

static const char help[] =
    "Usage: ccfread [OPTION]... FILE.ccf\n"
    "\n"
    "Shows the entries of a concise DCF (CiA 302-3), one line each: index:sub-index, size in "
    "bytes,\n"
    "the bytes, and what they are as a number (up to 8 bytes) or as text.\n"
    "\n"
    "      --json     as a JSON array\n"
    "  -h, --help     shows this\n"
    "      --version  shows the version\n"
    "\n"
    "Exit codes: 0 shown; 2 wrong usage, or the file is no whole concise DCF.\n";

enum { OPTION_JSON = 256, OPTION_VERSION };

static const struct option options[] = {
    { "json", no_argument, NULL, OPTION_JSON },
    { "help", no_argument, NULL, 'h' },
    { "version", no_argument, NULL, OPTION_VERSION },
    { NULL, 0, NULL, 0 },
};

static bool is_text(const struct ccf_entry *entry)
{
    for (uint32_t i = 0; i < entry->size; i++) {
        if (entry->value[i] < 0x20 || entry->value[i] > 0x7E)
            return false;
    }
    return entry->size > 0;
}

static void print_line(const struct ccf_entry *entry)
{
    printf("%04X:%02X  %lu ", entry->index, entry->sub, (unsigned long)entry->size);
    for (uint32_t i = 0; i < entry->size; i++)
        printf(" %02X", entry->value[i]);
    if (entry->size > 0 && entry->size <= NUMBER_SIZE)
        printf("  = %llu", (unsigned long long)get_le(entry->value, entry->size));
    if (is_text(entry) && entry->size >= 4) /* shorter ones are numbers, as a rule */
        printf("  \"%.*s\"", (int)entry->size, (const char *)entry->value);
    putchar('\n');
}

static void print_json(const struct ccf_entry *entry, bool first)
{
    printf("%s\n  {\"index\": %u, \"sub\": %u, \"size\": %lu, \"data\": \"", first ? "" : ",",
           entry->index, entry->sub, (unsigned long)entry->size);
    for (uint32_t i = 0; i < entry->size; i++)
        printf("%02X", entry->value[i]);
    putchar('"');
    if (entry->size > 0 && entry->size <= NUMBER_SIZE)
        printf(", \"value\": %llu", (unsigned long long)get_le(entry->value, entry->size));
    putchar('}');
}

static void print_all(const struct ccf *ccf, bool json)
{
    struct ccf_reader reader;
    struct ccf_entry entry;
    bool first = true;

    if (json)
        putchar('[');
    ccf_reader_init(&reader, ccf);
    while (ccf_read(&reader, &entry)) {
        if (json)
            print_json(&entry, first);
        else
            print_line(&entry);
        first = false;
    }
    if (json)
        puts(first ? "]" : "\n]");
}

static int show(const char *name, bool json)
{
    struct co_report report = { .file = name, .sink = file_report_line };
    struct ccf ccf;
    char *bytes;
    size_t size;
    enum co_err err = file_read(name, &bytes, &size);

    if (err != CO_OK) {
        file_tell("ccfread", name, err);
        return EXIT_TROUBLE;
    }
    err = ccf_parse((const uint8_t *)bytes, size, &report, &ccf);
    free(bytes);
    if (err != CO_OK)
        return EXIT_TROUBLE;
    print_all(&ccf, json);
    ccf_done(&ccf);
    return fflush(stdout) == 0 && !ferror(stdout) ? 0 : EXIT_TROUBLE;
}

int main(int argc, char **argv)
{
    bool json = false;
    int option;

    if (argc < 2) {
        fputs(help, stderr);
        return EXIT_TROUBLE;
    }
    while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        switch (option) {
        case OPTION_JSON: json = true; break;
        case 'h': return fputs(help, stdout) < 0 ? EXIT_TROUBLE : 0;
        case OPTION_VERSION: return tool_print_version("ccfread") ? 0 : EXIT_TROUBLE;
        default: fputs("Try 'ccfread --help'.\n", stderr); return EXIT_TROUBLE;
        }
    }
    if (optind + 1 != argc) {
        fputs("ccfread: one file expected\nTry 'ccfread --help'.\n", stderr);
        return EXIT_TROUBLE;
    }
    return show(argv[optind], json);
}
