/*
 * { "file", "bootable", "errors", "warnings", "messages": [ { "file", "line", "severity", "rule",
 *   "clause", "text" } ... ], "networks": [ { ..., "nodes": [ ... ], "bus_load", "boot" } ... ] }
 */
#include "mcanopen_check.h"

#include "json/json_text.h"

#include <stdio.h>
#include <string.h>

static json_t *text_or_null(const char *text)
{
    return text && text[0] != '\0' ? json_text(text) : json_null();
}

/* The file stands at the beginning of the text: "file:line: severity: body". */
static json_t *file_of(const struct co_message *message)
{
    const size_t place = (size_t)(message->body - message->text);
    char rest[40];
    int size;

    if (message->line != 0)
        size = snprintf(rest, sizeof rest, ":%u: %s: ", message->line,
                        co_severity_text(message->severity));
    else
        size = snprintf(rest, sizeof rest, ": %s: ", co_severity_text(message->severity));
    if (place <= (size_t)size)
        return json_null();
    return json_text_of(message->text, place - (size_t)size);
}

bool check_add_json(struct check *self, const struct co_message *message)
{
    const struct co_rule *rule = message->rule;

    if (!self->messages)
        self->messages = json_array();
    return json_array_append_new(
               self->messages,
               json_pack("{s:o, s:o, s:s, s:o, s:o, s:o}", "file", file_of(message), "line",
                         message->line ? json_integer(message->line) : json_null(), "severity",
                         co_severity_text(message->severity), "rule",
                         text_or_null(rule ? rule->name : NULL), "clause",
                         text_or_null(rule ? rule->clause : NULL), "text",
                         json_text(message->body))) == 0;
}

static json_t *node_of(const struct audit_node *node)
{
    const struct node_config *config = node->config;
    const int32_t heartbeat = audit_heartbeat_time(node);

    return json_pack("{s:i, s:o, s:s, s:o, s:b, s:I, s:I, s:o, s:o, s:i, s:i, s:i}", "node",
                     (int)config->node_id, "name", text_or_null(config->name), "kind",
                     check_kind(config), "file", text_or_null(node->file), "described",
                     (int)node->described, "writes", (json_int_t)ccf_count(&config->ccf), "bytes",
                     (json_int_t)config->ccf.size, "compared",
                     text_or_null(check_compared(config).text), "heartbeat_ms",
                     heartbeat < 0 ? json_null() : json_integer(heartbeat), "lost_after_ms",
                     (int)config->consumer_heartbeat_time, "guard_time_ms", (int)config->guard_time,
                     "life_time_factor", (int)config->life_time_factor);
}

static json_t *nodes_of(const struct audit_network *network)
{
    json_t *nodes = json_array();

    for (size_t i = 0; i < network->node_count; i++)
        if (json_array_append_new(nodes, node_of(&network->nodes[i])) != 0) {
            json_decref(nodes);
            return NULL;
        }
    return nodes;
}

static double percent(const struct audit_network *network, uint64_t rate)
{
    return (double)check_share(network, rate) / 10;
}

static json_t *load_of(const struct audit_network *network)
{
    const struct audit_load *load = &network->load;

    return json_pack("{s:f, s:f, s:i, s:i}", "cyclic_percent", percent(network, load->cyclic),
                     "most_percent", percent(network, load->most), "not_counted_pdos",
                     (int)load->unbounded, "not_known_nodes", (int)load->unknown);
}

static json_t *boot_of(const struct audit_network *network)
{
    const struct audit_boot *boot = &network->boot;

    return json_pack("{s:i, s:I, s:I, s:i}", "requests", (int)boot->requests, "likely_us",
                     (json_int_t)boot->likely, "least_us", (json_int_t)boot->least, "boot_delay_ms",
                     (int)network->config->boot_delay);
}

static json_t *network_of(const struct audit_network *network)
{
    const struct network_config *config = network->config;

    return json_pack("{s:i, s:o, s:i, s:i, s:o, s:o, s:o}", "net", (int)config->net, "name",
                     text_or_null(config->name), "kbit_per_s", (int)config->baudrate, "manager",
                     (int)config->manager_node_id, "nodes", nodes_of(network), "bus_load",
                     load_of(network), "boot", boot_of(network));
}

static json_t *networks_of(const struct audit *audit)
{
    json_t *networks = json_array();

    for (size_t i = 0; i < audit->count; i++)
        if (json_array_append_new(networks, network_of(&audit->networks[i])) != 0) {
            json_decref(networks);
            return NULL;
        }
    return networks;
}

bool check_print_json(struct check *self)
{
    json_t *messages = self->messages ? self->messages : json_array();

    self->messages = NULL;
    return json_write(json_pack("{s:o, s:b, s:i, s:i, s:o, s:o}", "file",
                                json_text(self->audit.xml_path), "bootable",
                                (int)!check_is_bad(self), "errors", (int)self->errors, "warnings",
                                (int)self->warnings, "messages", messages, "networks",
                                networks_of(&self->audit)),
                      JSON_INDENT(1), stdout) &&
           putchar('\n') != EOF;
}
