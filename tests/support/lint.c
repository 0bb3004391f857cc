#include "support/lint.h"

#include "support/guarded.h"

#include "dcf/dcf_compare.h"
#include "dcf/dcf_lint.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

#define TEXT_SIZE 100000

/* Sections, as people write them in any order, and which can be taken up again. */
static const char device[] =
    "[FileInfo]\nFileName=a.eds\nFileVersion=1\nFileRevision=0\nEDSVersion=4.0\n"
    "[DeviceInfo]\nVendorName=V\nVendorNumber=0x17\nProductName=P\nBaudRate_500=1\n"
    "BaudRate_125=1\n"
    "[DummyUsage]\nDummy0005=1\nDummy0006=0\n"
    "[MandatoryObjects]\nSupportedObjects=0\n[OptionalObjects]\nSupportedObjects=0\n"
    "[ManufacturerObjects]\nSupportedObjects=0\n" VALUE("1000", "7", "ro", "0")
        VALUE("1001", "5", "ro", "0") VALUE("1017", "6", "rw", "1000") RECORD_OF("1018", 2)
            VALUE("1018sub0", "5", "const", "1") VALUE("1018sub1", "7", "ro", "0x17");

struct lint_log {
    unsigned first_line; /* as 1 */
    char text[TEXT_SIZE];
};

static struct lint_log told;

static void collect(void *context, const struct co_message *message)
{
    struct lint_log *self = context;
    size_t used = strlen(self->text);
    unsigned line = message->line > self->first_line ? message->line - self->first_line : 0;

    ck_assert_ptr_nonnull(message->rule);
    ck_assert_int_eq(message->severity, CO_WARNING);
    snprintf(self->text + used, sizeof self->text - used, "%u %s: %s\n", line, message->rule->name,
             message->body);
}

static unsigned count_lines(const char *text)
{
    unsigned count = 0;

    for (; *text; text++)
        count += *text == '\n';
    return count;
}

static void parse(const char *text, struct dcf *ret_dcf)
{
    struct co_report report = { .file = "a.eds" };

    ck_assert_msg(guarded_dcf_parse(text, strlen(text), &report, ret_dcf) == CO_OK, "%s",
                  report.first_error);
}

static void parse_device(const char *added, struct dcf *ret_dcf)
{
    static char text[TEXT_SIZE];

    snprintf(text, sizeof text, "%s%s", device, added);
    parse(text, ret_dcf);
}

static struct co_report start_log(unsigned first_line)
{
    told.first_line = first_line;
    told.text[0] = '\0';
    return (struct co_report){ .file = "a.eds", .sink = collect, .context = &told };
}

static const char *lint_and_free(struct dcf *dcf, unsigned first_line)
{
    struct co_report report = start_log(first_line);

    ck_assert_int_eq(dcf_lint(dcf, &report), CO_OK);
    dcf_done(dcf);
    return told.text;
}

const char *lint_of(const char *added)
{
    struct dcf dcf;

    parse_device(added, &dcf);
    return lint_and_free(&dcf, count_lines(device));
}

void lint_check(const struct lint_row *row)
{
    const char *messages = lint_of(row->added);

    ck_assert_msg(strcmp(messages, row->messages) == 0, "%s:\n%s", row->name, messages);
}

const char *lint_of_file(const char *text)
{
    struct dcf dcf;

    parse(text, &dcf);
    return lint_and_free(&dcf, 0);
}

const char *comparison_of(const char *dcf_text, const char *eds_text)
{
    struct co_report report = start_log(count_lines(device));
    struct dcf dcf, eds;

    parse_device(dcf_text, &dcf);
    parse_device(eds_text, &eds);
    dcf_compare(&dcf, &eds, &report);
    dcf_done(&dcf);
    dcf_done(&eds);
    return told.text;
}
