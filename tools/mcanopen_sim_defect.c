#include "mcanopen_sim_defect.h"

#include "base/bytes.h"
#include "od/abort.h"
#include "proto/sdo_client.h"

#include <stdio.h>
#include <string.h>

#define DOWNLOAD_CONFIRMED 0x60u
#define ABORTED            0x80u

static const struct sim_defect *const tables[] = { sim_defects_sdo,    sim_defects_block,
                                                   sim_defects_od,     sim_defects_pdo,
                                                   sim_defects_errors, sim_defects_nmt };

const struct sim_defect *sim_defect_find(const char *name)
{
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++)
        for (const struct sim_defect *row = tables[i]; row->name; row++)
            if (strcmp(row->name, name) == 0)
                return row;
    return NULL;
}

void sim_defect_list(void)
{
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++)
        for (const struct sim_defect *row = tables[i]; row->name; row++)
            printf("%-7s  %-26s  %s\n", row->family, row->name, row->text);
}

/* --- what is what --- */

bool defect_is_from(const struct sim_gate *gate, const struct co_frame *frame, uint32_t base)
{
    return frame->id == base + gate_view(gate)->node &&
           (frame->flags & (CO_FRAME_RTR | CO_FRAME_EXT)) == 0;
}

bool defect_concerns(const struct sim_defect *defect, const struct co_frame *sdo)
{
    const uint16_t index = get_le16(sdo->data + 1);

    if (defect->first == 0 && defect->last == 0)
        return true;
    return index >= defect->first && index <= defect->last &&
           (defect->sub == DEFECT_ANY_SUB || defect->sub == sdo->data[3]);
}

bool defect_is_value(const struct sim_gate *gate, const struct co_frame *frame)
{
    return defect_is_from(gate, frame, SDO_RESPONSE_ID) && frame->dlc == 8 &&
           gate_view(gate)->request.data[0] == 0x40 && (frame->data[0] & 0xE2) == 0x42;
}

struct co_frame defect_answer(const struct sim_gate *gate, uint8_t command)
{
    const struct sim_device_view *view = gate_view(gate);
    struct co_frame answer = co_frame_make(SDO_RESPONSE_ID + view->node, 8);

    answer.data[0] = command;
    memcpy(answer.data + 1, view->initiate.data + 1, 3);
    return answer;
}

/* --- shared functions --- */

bool defect_lose(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    return !defect_is_from(gate, frame, use->defect->number);
}

static bool is_expedited_write(const struct co_frame *request)
{
    return (request->data[0] & 0xE2) == 0x22;
}

static bool is_code_of(const struct sim_defect *defect, uint32_t code)
{
    for (unsigned i = 0; i < DEFECT_CODES_MAX && defect->codes[i]; i++)
        if (defect->codes[i] == code)
            return true;
    return false;
}

bool defect_confirm_refused(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (defect_is_from(gate, frame, SDO_RESPONSE_ID) && frame->data[0] == ABORTED &&
        is_expedited_write(&gate_view(gate)->request) && defect_concerns(use->defect, frame) &&
        is_code_of(use->defect, get_le32(frame->data + 4)))
        *frame = defect_answer(gate, DOWNLOAD_CONFIRMED);
    return true;
}

/* Sub-index 0 of a record is no value. */
static bool is_swallowed(const struct sim_defect *defect, const struct co_frame *request)
{
    return is_expedited_write(request) && defect_concerns(defect, request) &&
           (defect->sub != DEFECT_ANY_SUB || request->data[3] != 0) &&
           (defect->number == 0 || defect->number == get_le32(request->data + 4));
}

bool defect_swallow_write(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    struct co_frame answer;

    if (!defect_is_from(gate, frame, SDO_REQUEST_ID) || gate_view(gate)->block_segment ||
        !is_swallowed(use->defect, frame))
        return true;
    answer = defect_answer(gate, DOWNLOAD_CONFIRMED);
    gate_to_bus(gate, &answer);
    return false;
}

bool defect_alter_value(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (defect_is_value(gate, frame) && defect_concerns(use->defect, frame))
        put_le32(frame->data + 4, get_le32(frame->data + 4) ^ use->defect->number);
    return true;
}
