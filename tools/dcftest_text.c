/* "file:line: severity: text [rule-name]", as compilers have it and editors read it. */
#include "dcftest.h"

bool finding_is_shown(const struct settings *settings, const struct finding *finding)
{
    return settings->quiet == 0 || (settings->quiet == 1 && !finding->is_minor);
}

unsigned shown_line(const struct finding *finding)
{
    return finding->line ? finding->line : 1;
}

static bool print(const struct result *result, const struct finding *finding)
{
    const bool nowhere = finding->rule == &tool_rules[RULE_UNREADABLE];
    int printed = nowhere ? printf("%s:", result->file)
                          : printf("%s:%u:", result->file, shown_line(finding));

    if (printed >= 0)
        printed = printf(" %s: %s", co_severity_text(finding->severity), finding->text);
    if (finding->rule && printed >= 0)
        printed = printf(" [%s]", finding->rule->name);
    return printed >= 0 && putchar('\n') != EOF;
}

static bool begin(struct output *self)
{
    (void)self;
    return true;
}

static bool write_result(struct output *self, const struct result *result)
{
    const struct finding *finding;

    for (size_t i = 0; (finding = result_at(result, i)) != NULL; i++)
        if (finding_is_shown(self->settings, finding) && !print(result, finding))
            return false;
    return true;
}

static const char *plural(unsigned long count)
{
    return count == 1 ? "" : "s";
}

static bool end(struct output *self)
{
    const struct totals *totals = &self->totals;

    if (!self->settings->summary || self->settings->quiet >= 2)
        return true;
    if (fflush(stdout) != 0) /* the summary comes last, where both go to one place */
        return false;
    fprintf(stderr, "%lu file%s, %lu error%s, %lu warning%s\n", totals->files,
            plural(totals->files), totals->errors, plural(totals->errors), totals->warnings,
            plural(totals->warnings));
    return true;
}

const struct writer text_writer = { begin, write_result, end };
