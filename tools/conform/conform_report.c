#include "conform.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

const char *conform_verdict_text(enum conform_verdict verdict)
{
    switch (verdict) {
    case CONFORM_PASS: return "PASS";
    case CONFORM_FAIL: return "FAIL";
    case CONFORM_SKIP: return "SKIP";
    case CONFORM_HELP: return "NEEDS-HELP";
    }
    return "";
}

static unsigned count(const struct conform *self, enum conform_verdict verdict)
{
    unsigned number = 0;

    for (size_t i = 0; i < self->result_count; i++)
        number += self->results[i].verdict == verdict;
    return number;
}

/* Each line of the text with the same space before it. */
static void print_indented(const char *text, FILE *stream)
{
    for (const char *line = text; *line;) {
        const size_t length = strcspn(line, "\n");

        fprintf(stream, "              %.*s\n", (int)length, line);
        line += length + (line[length] == '\n');
    }
}

/* --- text --- */

void conform_print_result(const struct conform *self, const struct conform_result *result)
{
    const bool failed = result->verdict == CONFORM_FAIL;

    if (self->options.json || (self->options.quiet && !failed))
        return;
    printf("%-10s  %-32s %s\n", conform_verdict_text(result->verdict), result->check->name,
           result->check->title);
    if (result->reason)
        print_indented(result->reason, stdout);
    if (failed)
        printf("              (%s)\n", result->check->clause);
    if (result->trace && (failed || self->options.verbose))
        print_indented(result->trace, stdout);
    fflush(stdout);
}

void conform_print_summary(const struct conform *self)
{
    printf("node %u on %s: %zu checks, %u passed, %u failed, %u skipped, %u need help\n",
           self->options.node, self->options.bus, self->result_count, count(self, CONFORM_PASS),
           count(self, CONFORM_FAIL), count(self, CONFORM_SKIP), count(self, CONFORM_HELP));
    if (self->lost > 0)
        printf("warning: %u frames were lost by the tester; failures may be due to that\n",
               self->lost);
}

/* --- JSON --- */

static void print_string(const char *text)
{
    putchar('"');
    for (; text && *text; text++) {
        const unsigned char c = (unsigned char)*text;

        if (c == '"' || c == '\\')
            printf("\\%c", c);
        else if (c < 0x20 || c >= 0x7F)
            printf("\\u%04x", c);
        else
            putchar(c);
    }
    putchar('"');
}

static void print_member(const char *name, const char *text, const char *end)
{
    printf("\"%s\": ", name);
    print_string(text);
    fputs(end, stdout);
}

/* A list of its lines. */
static void print_lines(const char *text)
{
    putchar('[');
    for (const char *line = text; line && *line;) {
        const size_t length = strcspn(line, "\n");
        char one[128];

        snprintf(one, sizeof one, "%.*s", (int)length, line);
        fputs(line == text ? "" : ", ", stdout);
        print_string(one);
        line += length + (line[length] == '\n');
    }
    putchar(']');
}

static void print_json_result(const struct conform_result *result)
{
    fputs("    {", stdout);
    print_member("name", result->check->name, ", ");
    print_member("family", result->family->name, ", ");
    print_member("title", result->check->title, ", ");
    print_member("clause", result->check->clause, ", ");
    print_member("verdict", conform_verdict_text(result->verdict), ", ");
    print_member("reason", result->reason, ", ");
    printf("\"seconds\": %.6f, \"frames\": ", (double)result->duration / 1e6);
    print_lines(result->trace);
    putchar('}');
}

void conform_print_json(const struct conform *self)
{
    printf("{\n  \"node\": %u, ", self->options.node);
    print_member("bus", self->options.bus, ", ");
    print_member("eds", self->options.eds, ",\n  ");
    print_member("ended", self->message, ", ");
    printf("\"lost\": %u,\n", self->lost);
    printf("  \"passed\": %u, \"failed\": %u, \"skipped\": %u, \"help\": %u,\n  \"checks\": [\n",
           count(self, CONFORM_PASS), count(self, CONFORM_FAIL), count(self, CONFORM_SKIP),
           count(self, CONFORM_HELP));
    for (size_t i = 0; i < self->result_count; i++) {
        print_json_result(&self->results[i]);
        puts(i + 1 < self->result_count ? "," : "");
    }
    puts("  ]\n}");
}

/* --- JUnit --- */

/* Also in the text of an element; what XML cannot say at all becomes '?'. */
static void put_xml(FILE *stream, const char *text)
{
    for (; text && *text; text++) {
        const unsigned char c = (unsigned char)*text;

        if (c == '&' || c == '<' || c == '>' || c == '"')
            fprintf(stream, "&#%u;", c);
        else
            fputc((c < 0x20 && c != '\n') || c >= 0x7F ? '?' : c, stream);
    }
}

static void put_outcome(FILE *stream, const struct conform_result *result)
{
    const bool failed = result->verdict == CONFORM_FAIL;

    if (result->verdict == CONFORM_PASS)
        return;
    fprintf(stream, "    <%s message=\"", failed ? "failure" : "skipped");
    put_xml(stream, result->reason);
    fputs("\">", stream);
    if (failed)
        put_xml(stream, result->trace);
    fprintf(stream, "</%s>\n", failed ? "failure" : "skipped");
}

static void put_case(FILE *stream, const struct conform_result *result)
{
    fprintf(stream, "  <testcase classname=\"%s\" name=\"%s\" time=\"%.6f\">\n",
            result->family->name, result->check->name, (double)result->duration / 1e6);
    put_outcome(stream, result);
    fputs("  </testcase>\n", stream);
}

static void put_suite(FILE *stream, const struct conform *self)
{
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"mcanopen conform\"",
          stream);
    fprintf(stream, " tests=\"%zu\" failures=\"%u\" errors=\"%u\" skipped=\"%u\">\n",
            self->result_count, count(self, CONFORM_FAIL), self->end != CONFORM_RUNS,
            count(self, CONFORM_SKIP) + count(self, CONFORM_HELP));
    for (size_t i = 0; i < self->result_count; i++)
        put_case(stream, &self->results[i]);
    if (self->message[0] != '\0') {
        fputs("  <system-err>", stream);
        put_xml(stream, self->message);
        fputs("</system-err>\n", stream);
    }
    fputs("</testsuite>\n", stream);
}

bool conform_write_junit(const struct conform *self, const char *path)
{
    FILE *stream = fopen(path, "w");
    bool good = stream != NULL;

    if (good) {
        put_suite(stream, self);
        good = !ferror(stream);
        good = fclose(stream) == 0 && good;
    }
    if (!good)
        perror(path);
    return good;
}
