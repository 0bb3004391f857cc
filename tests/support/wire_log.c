#include "support/wire_log.h"

#include "base/frame.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NODES     128u
#define NMT_ID    0x000u
#define GUARD_ID  0x700u
#define LANE_NMT  0u
#define LANE_BEAT NODES /* + node-ID: its heartbeats; below: all its other frames */
#define LANES     (2u * NODES)

struct reader {
    const char *at;
    unsigned line;
    uint8_t lane_states[NODES]; /* told by the last heartbeat; 0xFF: none yet */
};

static void begin(struct reader *self, const char *text)
{
    *self = (struct reader){ .at = text };
    memset(self->lane_states, 0xFF, sizeof self->lane_states);
}

/* The frame of a line, if it has one. */
static bool parse_line(const char *line, size_t size, struct co_frame *ret_frame)
{
    char copy[128];
    char *rest = copy;

    if (size >= sizeof copy || line[0] == '#')
        return false;
    memcpy(copy, line, size);
    copy[size] = '\0';
    for (char *word = strtok_r(rest, " \t\r", &rest); word; word = strtok_r(rest, " \t\r", &rest))
        if (co_frame_parse(word, ret_frame))
            return true;
    return false;
}

static bool next_frame(struct reader *self, struct co_frame *ret_frame)
{
    while (*self->at) {
        const char *line = self->at;
        size_t size = strcspn(line, "\n");

        self->at += size + (line[size] == '\n');
        self->line++;
        if (parse_line(line, size, ret_frame))
            return true;
    }
    return false;
}

static bool is_heartbeat(const struct co_frame *frame)
{
    return frame->id > GUARD_ID && frame->id < GUARD_ID + NODES && frame->dlc == 1 &&
           frame->data[0] != 0 && frame->flags == 0;
}

static bool is_repeated(struct reader *self, const struct co_frame *frame)
{
    uint8_t *state = &self->lane_states[frame->id % NODES];

    if (*state == frame->data[0])
        return true;
    *state = frame->data[0];
    return false;
}

static bool is_in_lane(const struct co_frame *frame, unsigned lane)
{
    bool is_command = frame->id == NMT_ID && frame->dlc == 2;

    if (lane >= LANE_BEAT)
        return is_heartbeat(frame) && frame->id % NODES == lane - LANE_BEAT;
    if (is_heartbeat(frame))
        return false;
    if (is_command && lane != LANE_NMT)
        return frame->data[1] == 0 || frame->data[1] == lane;
    return frame->id % NODES == lane;
}

static bool next_in_lane(struct reader *self, unsigned lane, struct co_frame *ret_frame)
{
    while (next_frame(self, ret_frame))
        if (is_in_lane(ret_frame, lane) && (lane < LANE_BEAT || !is_repeated(self, ret_frame)))
            return true;
    return false;
}

static const char *frame_text(bool there, const struct co_frame *frame, char *text, size_t size)
{
    return there ? co_frame_format(frame, text, size) : "the end";
}

static bool is_lane_same(const char *expected, const char *actual, unsigned lane, char *difference,
                         size_t size)
{
    struct reader a, b;
    struct co_frame frame_a, frame_b;
    bool more_a, more_b;
    char text_a[CO_FRAME_TEXT_SIZE], text_b[CO_FRAME_TEXT_SIZE];

    begin(&a, expected);
    begin(&b, actual);
    do {
        more_a = next_in_lane(&a, lane, &frame_a);
        more_b = next_in_lane(&b, lane, &frame_b);
    } while (more_a && more_b && co_frame_equal(&frame_a, &frame_b));
    if (!more_a && !more_b)
        return true;
    snprintf(difference, size, "%s %u: expected %s (line %u), is %s (line %u)",
             lane >= LANE_BEAT  ? "heartbeats of node"
             : lane == LANE_NMT ? "network"
                                : "node",
             lane % NODES, frame_text(more_a, &frame_a, text_a, sizeof text_a), a.line,
             frame_text(more_b, &frame_b, text_b, sizeof text_b), b.line);
    return false;
}

bool wire_log_same(const char *expected, const char *actual, char *difference, size_t size)
{
    for (unsigned lane = 0; lane < LANES; lane++)
        if (!is_lane_same(expected, actual, lane, difference, size))
            return false;
    return true;
}

char *wire_log_read(const char *name)
{
    char path[512];
    char *text = NULL;
    size_t size = 0;
    FILE *file, *stream;
    int c;

    snprintf(path, sizeof path, "%s/%s", TEST_DATA_DIR, name);
    file = fopen(path, "r");
    if (!file)
        return NULL;
    stream = open_memstream(&text, &size);
    while (stream && (c = getc(file)) != EOF)
        putc(c, stream);
    if (stream)
        fclose(stream);
    fclose(file);
    return text;
}
