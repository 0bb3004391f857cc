/* The nodes as a table, and the estimates. */
#include "mcanopen_check.h"

#include <stdio.h>
#include <string.h>

#define WIDTH_MAX 36

const char *check_kind(const struct node_config *config)
{
    if (!config->nmt_slave)
        return "no slave";
    return config->mandatory ? "mandatory" : "optional";
}

static void append(struct check_text *self, const char *word)
{
    const size_t used = strlen(self->text);

    snprintf(self->text + used, sizeof self->text - used, "%s%s", used > 0 ? " " : "", word);
}

struct check_text check_compared(const struct node_config *config)
{
    struct check_text text = { "" };

    if (config->device_type != 0)
        append(&text, "type");
    if (config->vendor_id != 0)
        append(&text, "vendor");
    if (config->product_code != 0)
        append(&text, "product");
    if (config->revision_number != 0)
        append(&text, "revision");
    if (config->serial_number != 0)
        append(&text, "serial");
    return text;
}

struct check_text check_supervision(const struct audit_node *node)
{
    const struct node_config *config = node->config;
    const int32_t producer = audit_heartbeat_time(node);
    struct check_text text = { "" };

    if (config->consumer_heartbeat_time != 0 && producer > 0)
        snprintf(text.text, sizeof text.text, "heartbeat %d ms, lost after %u ms", (int)producer,
                 config->consumer_heartbeat_time);
    else if (config->consumer_heartbeat_time != 0)
        snprintf(text.text, sizeof text.text, "heartbeat, lost after %u ms",
                 config->consumer_heartbeat_time);
    else if (audit_is_guarded(node))
        snprintf(text.text, sizeof text.text, "guarding %u ms x %u", config->guard_time,
                 config->life_time_factor);
    return text;
}

static const char *or_dash(const char *text)
{
    return text && text[0] != '\0' ? text : "-";
}

static const char *file_of(const struct audit_node *node)
{
    return or_dash(node->config->dcf_file ? node->config->dcf_file : node->config->ccf_file);
}

static int wider(int width, const char *text)
{
    const size_t size = strlen(text);

    if (size > WIDTH_MAX)
        return WIDTH_MAX;
    return (int)size > width ? (int)size : width;
}

static void print_table(const struct audit_network *network)
{
    int name = 4, file = 4, compared = 8;

    for (size_t i = 0; i < network->node_count; i++) {
        name = wider(name, or_dash(network->nodes[i].config->name));
        file = wider(file, file_of(&network->nodes[i]));
        compared = wider(compared, check_compared(network->nodes[i].config).text);
    }
    printf("node  %-*s  %-9s  %-*s  writes   bytes  %-*s  error control\n", name, "name", "kind",
           file, "file", compared, "compared");
    for (size_t i = 0; i < network->node_count; i++) {
        const struct audit_node *node = &network->nodes[i];
        const struct node_config *config = node->config;
        const size_t size = config->ccf.size;

        printf("%4u  %-*s  %-9s  %-*s  %6lu  %6lu  %-*s  %s\n", config->node_id, name,
               or_dash(config->name), check_kind(config), file, file_of(node),
               (unsigned long)ccf_count(&config->ccf), (unsigned long)size, compared,
               or_dash(check_compared(config).text), or_dash(check_supervision(node).text));
    }
}

unsigned long check_share(const struct audit_network *network, uint64_t rate)
{
    const uint64_t tenth = network->config->baudrate * 1000ull; /* of a per cent */

    return (unsigned long)((rate + tenth / 2) / tenth);
}

static void print_load(const struct audit_network *network)
{
    const struct audit_load *load = &network->load;
    const unsigned long cyclic = check_share(network, load->cyclic),
                        most = check_share(network, load->most);

    printf("bus load: %lu.%lu %% by timers and SYNC", cyclic / 10, cyclic % 10);
    if (load->most > load->cyclic)
        printf(", %lu.%lu %% with event-driven PDOs at their inhibit times", most / 10, most % 10);
    if (load->unbounded > 0)
        printf("; not counted: %u event-driven PDO%s without inhibit time", load->unbounded,
               load->unbounded == 1 ? "" : "s");
    if (load->unknown > 0)
        printf("; %u node%s not known", load->unknown, load->unknown == 1 ? " is" : "s are");
    putchar('\n');
}

static void print_boot(const struct audit_network *network)
{
    const struct audit_boot *boot = &network->boot;

    printf("boot: %u requests, about %lu ms after Boot_Delay (%u ms), if devices answer in %u ms; "
           "%lu ms on the wire alone\n",
           boot->requests, (unsigned long)((boot->likely + 999) / 1000),
           network->config->boot_delay, AUDIT_ANSWER_TIME / 1000,
           (unsigned long)((boot->least + 999) / 1000));
}

static void print_network(const struct audit_network *network)
{
    const struct network_config *config = network->config;

    printf("\nnetwork %u%s%s%s: %u kbit/s, manager is node %u, %lu node%s\n", config->net,
           config->name ? " \"" : "", config->name ? config->name : "", config->name ? "\"" : "",
           config->baudrate, config->manager_node_id, (unsigned long)network->node_count,
           network->node_count == 1 ? "" : "s");
    if (network->node_count > 0)
        print_table(network);
    print_load(network);
    print_boot(network);
}

static const char *verdict(const struct check *self)
{
    if (self->errors > 0)
        return "not fit to boot";
    return check_is_bad(self) ? "not fit to boot (--strict)" : "nothing against a boot";
}

void check_print_summary(const struct check *self)
{
    for (size_t i = 0; i < self->audit.count; i++)
        print_network(&self->audit.networks[i]);
    printf("%s%s: %u error%s, %u warning%s: %s\n", self->audit.count > 0 ? "\n" : "",
           self->audit.xml_path, self->errors, self->errors == 1 ? "" : "s", self->warnings,
           self->warnings == 1 ? "" : "s", verdict(self));
}
