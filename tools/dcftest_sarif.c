/*
 * SARIF 2.1.0 (OASIS): one run, the rules in its tool, a result for each finding.
 *
 * Result by result: all of them together may be more than there is memory.
 */
#include "dcftest.h"

#include "json/json_text.h"

#include <stdlib.h>
#include <string.h>

#define SCHEMA "https://docs.oasis-open.org/sarif/sarif/v2.1.0/os/schemas/sarif-schema-2.1.0.json"

static const char *level_of(enum co_severity severity)
{
    switch (severity) {
    case CO_ERROR: return "error";
    case CO_WARNING: return "warning";
    case CO_INFO: return "note";
    }
    return "error";
}

static json_t *rule_object(const struct co_rule *rule)
{
    char help[512];
    const char *code = rule_code(rule);

    snprintf(help, sizeof help, "%s\n%s%s%s.", rule->text, rule->clause, code ? ", " : "",
             code ? code : "");
    return json_pack("{s:s, s:{s:s}, s:{s:s}, s:{s:s}, s:{s:s}}", "id", rule->name,
                     "shortDescription", "text", rule->text, "help", "text", help,
                     "defaultConfiguration", "level", level_of(rule->severity), "properties",
                     "clause", rule->clause);
}

static json_t *rule_objects(void)
{
    json_t *rules = json_array();

    for (size_t i = 0; rules && i < RULE_COUNT; i++) {
        if (json_array_append_new(rules, rule_object(rule_at(i))) != 0) {
            json_decref(rules);
            return NULL;
        }
    }
    return rules;
}

static bool begin(struct output *self)
{
    char version[32];
    json_t *tool;

    (void)self;
    snprintf(version, sizeof version, "%d.%d.%d", MCANOPEN_VERSION_MAJOR, MCANOPEN_VERSION_MINOR,
             MCANOPEN_VERSION_PATCH);
    tool = json_pack("{s:{s:s, s:s, s:s, s:o}}", "driver", "name", "dcftest", "version", version,
                     "semanticVersion", version, "rules", rule_objects());
    return fputs("{\"version\": \"2.1.0\", \"$schema\": \"" SCHEMA "\", \"runs\": [{\"tool\":\n",
                 stdout) >= 0 &&
           json_write(tool, JSON_INDENT(1), stdout) && fputs(",\n\"results\": [", stdout) >= 0;
}

static bool stays_in_uri(char c)
{
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           strchr("-._~/", c) != NULL;
}

/* A path as RFC 3986 has it; absolute ones with their scheme. */
static json_t *uri_of(const char *path)
{
    static const char digits[] = "0123456789ABCDEF";
    char *uri = malloc(sizeof "file://" + 3 * strlen(path));
    json_t *result;
    size_t size;

    if (!uri)
        return NULL;
    size = (size_t)sprintf(uri, "%s", path[0] == '/' ? "file://" : "");
    for (; *path; path++) {
        if (stays_in_uri(*path)) {
            uri[size++] = *path;
        } else {
            uri[size++] = '%';
            uri[size++] = digits[(unsigned char)*path >> 4];
            uri[size++] = digits[(unsigned char)*path & 15];
        }
    }
    result = json_stringn(uri, size);
    free(uri);
    return result;
}

static json_t *object_of(const struct finding *finding)
{
    char name[24];

    if (finding->sub >= 0)
        snprintf(name, sizeof name, "%04Xh:%02X", (unsigned)finding->index, (unsigned)finding->sub);
    else
        snprintf(name, sizeof name, "%04Xh", (unsigned)finding->index);
    return json_pack("[{s:s}]", "name", name);
}

static json_t *location_of(const struct result *result, const struct finding *finding)
{
    json_t *physical = json_pack("{s:{s:o}}", "artifactLocation", "uri", uri_of(result->file));
    json_t *location;

    if (finding->rule != &tool_rules[RULE_UNREADABLE])
        physical = json_with(physical, "region",
                             json_pack("{s:I}", "startLine", (json_int_t)shown_line(finding)));
    location = json_pack("{s:o}", "physicalLocation", physical);
    return finding->index < 0 ? location
                              : json_with(location, "logicalLocations", object_of(finding));
}

static json_t *result_object(const struct result *result, const struct finding *finding)
{
    const size_t number = rule_number(finding->rule);
    json_t *object = json_pack("{s:s, s:{s:o}, s:[o]}", "level", level_of(finding->severity),
                               "message", "text", json_text(finding->text), "locations",
                               location_of(result, finding));

    if (number == RULE_COUNT)
        return object;
    object = json_with(object, "ruleId", json_text(finding->rule->name));
    return json_with(object, "ruleIndex", json_integer((json_int_t)number));
}

static bool write_result(struct output *self, const struct result *result)
{
    const struct finding *finding;

    for (size_t i = 0; (finding = result_at(result, i)) != NULL; i++) {
        if (!finding_is_shown(self->settings, finding))
            continue;
        if (fputs(self->parts++ > 0 ? ",\n" : "\n", stdout) < 0 ||
            !json_write(result_object(result, finding), 0, stdout))
            return false;
    }
    return true;
}

static bool end(struct output *self)
{
    json_t *invocation = json_pack("{s:b, s:i}", "executionSuccessful", 1, "exitCode",
                                   exit_code(self->settings, &self->totals));

    return fputs("\n],\n\"invocations\": [", stdout) >= 0 && json_write(invocation, 0, stdout) &&
           puts("]}]}") >= 0;
}

const struct writer sarif_writer = { begin, write_result, end };
