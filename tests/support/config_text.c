#include "support/config_text.h"

#include "support/guarded.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

static void collect(void *context, const struct co_message *message)
{
    struct config_result *result = context;
    size_t used = strlen(result->messages);

    ck_assert_int_eq(strncmp(message->text, "n.xml:", 6), 0);
    snprintf(result->messages + used, sizeof result->messages - used, "%s\n", message->text + 6);
}

struct config_result *config_parse_bytes(const char *text, size_t size)
{
    static struct config_result result;

    memset(&result, 0, sizeof result);
    result.report = (struct co_report){ .file = "n.xml", .sink = collect, .context = &result };
    result.err = guarded_config_parse(text, size, &result.report, &result.networks, &result.count);
    return &result;
}

struct config_result *config_parse(const char *text)
{
    return config_parse_bytes(text, strlen(text));
}

struct network_config *config_parse_one(const char *text)
{
    struct config_result *result = config_parse(text);

    ck_assert_str_eq(result->messages, "");
    ck_assert_int_eq(result->err, CO_OK);
    ck_assert_uint_eq(result->count, 1);
    return result->networks;
}
