/*
 * The SDO daemon: what clients' transfers need of the application, or of a file.
 *
 * It gets a token for a node that has something for it, one at a time for each node, so that its
 * queue cannot overflow. Each channel has one question at most; channels have their turns.
 */
#include "api/callback.h"
#include "api/file_draft.h"
#include "api/scan.h"

#include <stdlib.h>
#include <string.h>

/* ---- under the network's lock, by the protocol thread ---- */

bool scan_make_questions(struct scan_node *node)
{
    const unsigned count = node->slave.channel_count;
    struct scan_question *questions = calloc(count, sizeof *questions);

    if (!questions)
        return false;
    free(node->questions);
    node->questions = questions;
    node->question_count = count;
    node->question_next = 0;
    return true;
}

void scan_on_question(struct scan_node *node, const struct co_event *event, co_us_t now)
{
    const struct scan_token token = scan_token(node);

    node->questions[event->detail] = (struct scan_question){ .pending = true,
                                                             .reads = event->type == SLAVE_FETCH,
                                                             .index = event->index,
                                                             .sub = event->sub,
                                                             .size = (uint32_t)event->actual,
                                                             .transfer = { event->detail,
                                                                           event->code },
                                                             .time = now };
    if (node->sdo_called)
        return;
    node->sdo_called = true;
    network_put(node->net->network, &node->net->sdo, &token);
}

/* The next one whose client still waits; NULL: there is none. */
static struct scan_question *next_question(struct scan_node *node)
{
    for (unsigned i = 0; node->active && i < node->question_count; i++) {
        struct scan_question *question = &node->questions[node->question_next];
        const bool pending = question->pending;

        node->question_next = (node->question_next + 1) % node->question_count;
        question->pending = false;
        if (pending && slave_waits_for(&node->slave, question->transfer))
            return question;
    }
    return NULL;
}

/* ---- its thread ---- */

/* What is done for one client, under no lock. */
struct job {
    struct slave_transfer transfer;
    unsigned activation;
    bool reads;
    struct scan_call call;
    struct scan_domain *domain; /* a copy; NULL: the value is in the dictionary */
    uint8_t *bytes;
    uint32_t size;
};

static void end_job(struct job *job)
{
    free(job->domain);
    free(job->bytes);
}

/* With a NUL behind them, which does not count. */
static bool copy_received(struct job *job, const uint8_t *bytes, uint32_t size)
{
    job->bytes = malloc(size + 1u);
    if (!job->bytes)
        return false;
    if (size > 0)
        memcpy(job->bytes, bytes, size);
    job->bytes[size] = 0;
    job->size = size;
    return true;
}

/* SDO_OK, or why the client cannot be served. */
static sdo_abort_t fill_job(const struct scan_node *node, const struct scan_question *question,
                            struct job *job)
{
    const struct od_entry *entry = od_find(&node->od, question->index, question->sub);
    const struct scan_entry *owner = entry ? entry->owner : NULL;

    if (!owner)
        return SDO_INTERNAL;
    scan_make_call(node, entry, question->time, &job->call);
    if (owner->domain) {
        job->domain = scan_copy_domain(owner->domain);
        if (!job->domain)
            return SDO_NO_MEMORY;
    }
    if (question->reads)
        return SDO_OK;
    if (!copy_received(job, slave_received(&node->slave, question->transfer), question->size))
        return SDO_NO_MEMORY;
    scan_data_from(entry->type, job->bytes, job->size, &job->call.data);
    return SDO_OK;
}

static sdo_abort_t ask_handler(struct scan_call *call)
{
    sdo_abort_t code;

    if (!call->handlers.handler && !call->handlers.handler_ts)
        return SDO_OK;
    callback_begin();
    code = scan_code_of(scan_run_call(call, &call->data));
    callback_end();
    return code;
}

/* Under the lock. */
static bool still_waits(const struct scan_node *node, const struct job *job)
{
    return node->active && node->activations == job->activation &&
           slave_waits_for(&node->slave, job->transfer);
}

/* A client that has been told of a failure meanwhile finds the old file. */
static sdo_abort_t replace_file(const struct scan_node *node, const struct job *job)
{
    struct file_draft draft;
    enum co_err err = file_draft_write(&draft, job->domain->path, job->bytes, job->size);
    bool wanted;

    if (err != CO_OK)
        return scan_error_of_file(err);
    network_hold(node->net->network);
    wanted = still_waits(node, job);
    network_release(node->net->network);
    if (wanted)
        return scan_error_of_file(file_draft_take(&draft));
    file_draft_drop(&draft);
    return SDO_NOT_STORED;
}

static sdo_abort_t serve_write(const struct scan_node *node, struct job *job)
{
    const sdo_abort_t code = ask_handler(&job->call);

    return code == SDO_OK && job->domain ? replace_file(node, job) : code;
}

static sdo_abort_t serve_read(struct job *job)
{
    return job->domain ? scan_read_domain(job->domain, &job->bytes, &job->size) : SDO_INTERNAL;
}

static void answer(struct scan_node *node, const struct job *job, sdo_abort_t code)
{
    const struct slave_value value = { .code = code, .bytes = job->bytes, .size = job->size };
    co_us_t now;
    struct co_outbox *out = scan_lock(node, &now);

    if (still_waits(node, job) && job->reads)
        slave_give(&node->slave, job->transfer, &value, now, out);
    else if (still_waits(node, job))
        slave_verdict(&node->slave, job->transfer, code, now, out);
    scan_unlock(node);
}

/* False: no client waits. */
static bool serve_client(struct scan_node *node)
{
    struct scan_question *question;
    struct job job = { .bytes = NULL };
    sdo_abort_t code = SDO_OK;

    network_hold(node->net->network);
    question = next_question(node);
    node->sdo_called = question != NULL;
    if (question) {
        job.transfer = question->transfer;
        job.reads = question->reads;
        job.activation = node->activations;
        code = fill_job(node, question, &job);
    }
    network_release(node->net->network);
    if (!question)
        return false;
    if (code == SDO_OK)
        code = job.reads ? serve_read(&job) : serve_write(node, &job);
    answer(node, &job, code);
    end_job(&job);
    return true;
}

void scan_sdo_work(void *context, const void *element)
{
    struct scan_net *net = context;
    struct scan_node *node;

    if (scan_enter_token(element, &node) != SCANOPEN_OK)
        return;
    if (serve_client(node)) /* then perhaps others; after those of other nodes */
        daemon_put(&net->sdo, element);
    scan_leave(node);
}
