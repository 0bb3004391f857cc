/*
 * 1010h "save" and 1011h "load": the application is asked (EV_CONFIGURATION, in the NMT daemon),
 * then the power-on values are written to the node's file (canOpenSetStoreFile, in the store
 * daemon), then the client is answered. Without a handler or a file that step is left out.
 *
 * The file is a concise DCF (dcf/ccf.h) of all parameters whose power-on value is not their
 * DefaultValue, in the order of their objects.
 */
#include "api/callback.h"
#include "api/file.h"
#include "api/file_draft.h"
#include "api/log.h"
#include "api/scan.h"
#include "slave/slave_store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Waits also for a node that is being deleted, whose own place gives up all waiting. */
#define NO_PLACE         0u
#define STORE_PARAMETERS 0x1010u
#define STORE_ORDERS     1024u
#define EMPTY_SIZE       4u

/* ---- under the network's lock ---- */

void scan_watch_store(struct scan_node *node)
{
    const bool watched = scan_wants(node, EV_CONFIGURATION) || node->store_file != NULL;

    for (size_t i = 0; i < node->od.count; i++)
        if (slave_is_store_entry(node->od.entries[i]))
            node->od.entries[i]->watched = watched;
}

static struct scan_store_token token_of(const struct scan_node *node, const struct co_event *news)
{
    return (struct scan_store_token){ .node = scan_token(node),
                                      .transfer = { news->detail, news->code },
                                      .activation = (unsigned)news->expected };
}

bool scan_on_store(struct scan_node *node, const struct co_event *event)
{
    const struct od_entry *entry = od_find(&node->od, event->index, event->sub);
    struct scan_store_token token;
    struct co_event news = *event;

    if (!entry || !slave_is_store_entry(entry))
        return false;
    news.expected = node->activations;
    token = token_of(node, &news);
    if (scan_wants(node, EV_CONFIGURATION))
        scan_tell_configuration(node, &news);
    else
        daemon_put(&node->net->store, &token);
    return true;
}

void scan_end_texts(struct scan_node *node)
{
    for (size_t i = 0; i < node->od.count; i++)
        if (od_is_parameter(node->od.entries[i]) && scan_is_text(node->od.entries[i]->type))
            scan_end_text(node->od.entries[i]);
}

/* ---- the NMT daemon ---- */

static void decide(struct scan_node *node, const struct co_event *news, sdo_abort_t code)
{
    const struct scan_store_token token = token_of(node, news);
    co_us_t now;
    struct co_outbox *out = scan_lock(node, &now);

    if (code == SDO_OK && node->store_file)
        daemon_put(&node->net->store, &token);
    else if (node->active && node->activations == token.activation)
        slave_verdict(&node->slave, token.transfer, code, now, out);
    scan_unlock(node);
}

void scan_decide_store(const struct scan_token *token, const struct co_event *news, int result)
{
    struct scan_node *node;

    if (scan_enter_token(token, &node) != SCANOPEN_OK)
        return;
    decide(node, news, scan_code_of(result));
    scan_leave(node);
}

/* ---- the store daemon ---- */

static const char *failure_text(enum co_err err)
{
    if (err == CO_ERR_NOT_FOUND)
        return "no such folder";
    if (err == CO_ERR_AGAIN)
        return "another process is writing the file";
    return err == CO_ERR_IO ? "the disk is full or fails, or this is no file" : co_err_text(err);
}

static void log_failure(const struct scan_node *node, enum co_err err)
{
    char text[CO_REPORT_TEXT_SIZE];

    snprintf(text, sizeof text, "%s: error: the parameters of node %u could not be stored: %s",
             node->store_file, (unsigned)node->id, failure_text(err));
    log_put(CO_ERROR, text);
}

static bool is_in_file(const char *path, const uint8_t *bytes, size_t size)
{
    char *text = NULL;
    size_t length = 0;
    const bool same = file_read(path, &text, &length) == CO_OK && length == size &&
                      memcmp(text, bytes, size) == 0;

    free(text);
    return same;
}

/* When it is there it counts, even if nobody can say whether it outlives a power cut. */
static enum co_err replace_file(const char *path, const uint8_t *bytes, size_t size)
{
    struct file_draft draft;
    enum co_err err = file_draft_write(&draft, path, bytes, size);

    if (err != CO_OK)
        return err;
    err = file_draft_take(&draft);
    return err != CO_OK && is_in_file(path, bytes, size) ? CO_OK : err;
}

static sdo_abort_t write_image(const struct scan_node *node, const struct ccf *image)
{
    static const uint8_t empty[EMPTY_SIZE];
    const bool is_empty = image->size == 0;
    const enum co_err err = replace_file(node->store_file, is_empty ? empty : image->bytes,
                                         is_empty ? sizeof empty : image->size);

    if (err != CO_OK)
        log_failure(node, err);
    return err == CO_OK ? SLAVE_DONE : SDO_HARDWARE;
}

/* False: the client waits no more, or was told why not. */
static bool begin_store(struct scan_node *node, const struct scan_store_token *order,
                        struct slave_store *ret_store)
{
    enum co_err err = CO_ERR_STATE;
    co_us_t now;
    struct co_outbox *out = scan_lock(node, &now);

    if (node->active && node->activations == order->activation)
        err = slave_begin_store(&node->slave, order->transfer, now, ret_store);
    if (err == CO_OK)
        node->storing = true;
    else if (err != CO_ERR_STATE)
        slave_verdict(&node->slave, order->transfer, SDO_HARDWARE, now, out);
    scan_unlock(node);
    return err == CO_OK;
}

/* The node is active: who takes it from the bus waits for this. */
static void end_store(struct scan_node *node, const struct scan_store_token *order,
                      struct slave_store *store, sdo_abort_t code)
{
    co_us_t now;
    struct co_outbox *out = scan_lock(node, &now);

    if (code == SLAVE_DONE)
        slave_end_store(&node->slave, store);
    slave_verdict(&node->slave, order->transfer, code, now, out);
    node->storing = false;
    network_poke(node->net->network);
    scan_unlock(node);
}

void scan_store_work(void *context, const void *element)
{
    const struct scan_store_token *order = element;
    struct slave_store store;
    struct scan_node *node;

    (void)context;
    if (scan_enter_token(&order->node, &node) != SCANOPEN_OK)
        return;
    if (begin_store(node, order, &store)) {
        end_store(node, order, &store, write_image(node, &store.image));
        slave_free_store(&store);
    }
    scan_leave(node);
}

void scan_wait_stored(struct scan_node *node)
{
    while (node->storing)
        network_wait(node->net->network, NO_PLACE, CO_NEVER);
}

/* ---- canOpenSetStoreFile ---- */

static bool start_daemon(struct scan_net *net)
{
    if (net->stores)
        return true;
    net->store = (struct daemon){ .work = scan_store_work, .context = net };
    net->stores = daemon_start(&net->store, "mcan-store", sizeof(struct scan_store_token),
                               STORE_ORDERS) == CO_OK;
    return net->stores;
}

/* Where it is, wherever the process goes. NULL: no memory, or the process is nowhere. */
static char *absolute(const char *path)
{
    char *folder, *whole = NULL;

    if (path[0] == '/')
        return strdup(path);
    folder = getcwd(NULL, 0);
    if (folder && asprintf(&whole, "%s/%s", folder, path) < 0)
        whole = NULL;
    free(folder);
    return whole;
}

/* What is to be kept, and what was. */
struct kept {
    char *file; /* NULL: none */
    struct ccf image;
};

static void end_kept(struct kept *kept)
{
    free(kept->file);
    ccf_done(&kept->image);
}

/* What cannot be read leaves the DefaultValues. */
static int read_image(const char *path, struct ccf *ret_image)
{
    struct co_report report = { .file = path, .sink = log_sink };
    char *text = NULL;
    size_t size = 0;
    enum co_err err = file_read(path, &text, &size);

    if (err == CO_ERR_NOT_FOUND) /* nothing was ever stored */
        return SCANOPEN_OK;
    if (err == CO_OK)
        err = ccf_parse((const uint8_t *)text, size, &report, ret_image);
    else if (err != CO_ERR_MEMORY)
        co_report_add(&report, CO_ERROR, 0, "%s", file_error_text(err));
    free(text);
    if (err == CO_ERR_MEMORY)
        return SCANOPEN_OUT_OF_MEMORY;
    if (err != CO_OK)
        co_report_add(&report, CO_WARNING, 0,
                      "nothing is taken from it: the device has its default values, and the next "
                      "\"save\" replaces the file");
    return SCANOPEN_OK;
}

static int read_kept(const char *path, struct kept *kept)
{
    if (!path)
        return SCANOPEN_OK;
    kept->file = absolute(path);
    return kept->file ? read_image(path, &kept->image) : SCANOPEN_OUT_OF_MEMORY;
}

static int check_node(struct scan_node *node, const char *path)
{
    int result = SCANOPEN_OK;

    network_hold(node->net->network);
    if (node->active)
        result = SCANOPEN_WRONG_NODESTATE;
    else if (!od_has_object(&node->od, STORE_PARAMETERS))
        result = SCANOPEN_SERVICE_NOT_ALLOWED;
    network_release(node->net->network);
    return path && path[0] == '\0' ? SCANOPEN_WRONG_PARAMETER : result;
}

/* Under the lock. */
static int take_kept(struct scan_node *node, struct kept *kept, struct co_report *report)
{
    char *old = node->store_file;

    if (node->active)
        return SCANOPEN_WRONG_NODESTATE;
    if (kept->file && slave_recall_image(&node->od, &kept->image, report) != CO_OK)
        return SCANOPEN_OUT_OF_MEMORY;
    scan_end_texts(node);
    scan_count_maps(node);
    node->store_file = kept->file;
    kept->file = old;
    return SCANOPEN_OK;
}

/* Between scan_begin_change() and scan_end_change(): the messages wait for that. */
static int set_kept(struct scan_node *node, const char *path, struct kept *kept)
{
    struct co_report report = { .file = path, .sink = log_sink };
    int result;

    network_hold(node->net->network);
    result = take_kept(node, kept, &report);
    network_release(node->net->network);
    return result;
}

static int check_handle(HNODE handle, const char *path)
{
    struct scan_node *node;
    int result = scan_enter(handle, &node);

    if (result != SCANOPEN_OK)
        return result;
    result = check_node(node, path);
    scan_leave(node);
    return result;
}

static int set_store_file(HNODE handle, const char *path, struct kept *kept)
{
    struct scan_node *node;
    int result = scan_enter(handle, &node);

    if (result != SCANOPEN_OK)
        return result;
    if (path && !start_daemon(node->net))
        result = SCANOPEN_CANNOT_START_DAEMON;
    else
        result = set_kept(node, path, kept);
    scan_leave(node);
    return result;
}

int canOpenSetStoreFile(HNODE HNode, const char *FileName)
{
    struct kept kept = { .file = NULL };
    int result;

    if (callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    result = check_handle(HNode, FileName);
    if (result == SCANOPEN_OK)
        result = read_kept(FileName, &kept);
    if (result == SCANOPEN_OK) {
        scan_begin_change();
        result = set_store_file(HNode, FileName, &kept);
        scan_end_change();
    }
    end_kept(&kept);
    return result;
}
