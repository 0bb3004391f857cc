#include "check_common.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <string.h>

bool check_ask(struct conform *self, uint8_t command, uint16_t index, uint8_t sub,
               uint8_t ret_answer[8])
{
    uint8_t request[8];

    conform_request(request, command, index, sub);
    return conform_exchange(self, request, ret_answer);
}

bool check_step(struct conform *self, const uint8_t request[8], uint8_t expected,
                uint8_t ret_answer[8])
{
    if (!conform_exchange(self, request, ret_answer))
        return conform_fail(self,
                            "request %02X %02X %02X %02X: expected an answer %02X, received "
                            "none",
                            request[0], request[1], request[2], request[3], expected);
    if (ret_answer[0] == expected)
        return true;
    if (ret_answer[0] == 0x80)
        return conform_fail(self,
                            "request %02X %02X %02X %02X: expected an answer %02X, received "
                            "abort %08X (%s)",
                            request[0], request[1], request[2], request[3], expected,
                            (unsigned)get_le32(ret_answer + 4),
                            sdo_abort_text(get_le32(ret_answer + 4)));
    return conform_fail(self, "request %02X %02X %02X %02X: expected an answer %02X, received %02X",
                        request[0], request[1], request[2], request[3], expected, ret_answer[0]);
}

void check_give_up(struct conform *self, const struct conform_object *object)
{
    uint8_t request[8];

    conform_request(request, 0x80, object->index, object->sub);
    put_le32(request + 4, SDO_GENERAL);
    conform_send_data(self, 0x600u + self->options.node, request, sizeof request);
}

bool check_unchanged(struct conform *self, const struct conform_object *object,
                     const struct conform_value *before)
{
    struct conform_value now;

    if (!conform_must_read(self, object->index, object->sub, &now))
        return false;
    if (now.size == before->size && memcmp(now.bytes, before->bytes, sizeof now.bytes) == 0)
        return true;
    return conform_fail(self, "%04Xh:%02X: the value has changed, though the write was refused",
                        object->index, object->sub);
}

bool check_still_serves(struct conform *self)
{
    struct conform_value value;

    return conform_must_read(self, 0x1000, 0, &value);
}

bool check_is_writable(const struct conform_object *object)
{
    return object->access == OD_RW || object->access == OD_RWR || object->access == OD_RWW;
}

bool check_takes_signature(uint16_t index)
{
    return index == 0x1010 || index == 0x1011;
}

static bool is_writable_string(const struct conform_object *object)
{
    return check_is_writable(object) && object->entry && (object->entry->flags & 1u) == 0 &&
           (object->type == OD_VISIBLE_STRING || object->type == OD_OCTET_STRING);
}

const struct conform_object *check_writable_string(struct conform *self, uint32_t least)
{
    struct conform_value value;

    for (size_t i = 0; i < self->object_count; i++) {
        const struct conform_object *object = &self->objects[i];

        if (is_writable_string(object) &&
            conform_read(self, object->index, object->sub, &value) == SDO_OK &&
            value.size >= least && value.size <= CONFORM_VALUE_MAX)
            return object;
    }
    return NULL;
}

uint16_t check_crc16(const uint8_t *bytes, uint32_t size)
{
    uint16_t crc = 0;

    for (uint32_t i = 0; i < size; i++) {
        crc ^= (uint16_t)(bytes[i] << 8);
        for (unsigned bit = 0; bit < 8; bit++)
            crc = (uint16_t)(crc << 1 ^ (crc & 0x8000 ? 0x1021 : 0));
    }
    return crc;
}

/* --- limits --- */

/* Of a type of whole numbers: the value at one end. */
static int64_t end_of_type(uint8_t type, enum check_side side)
{
    const unsigned bits = 8 * od_type_size(type);

    if (od_type_signed(type))
        return side == CHECK_ABOVE ? (int64_t)(UINT64_MAX >> (65 - bits))
                                   : (int64_t)(UINT64_MAX << (bits - 1));
    return side == CHECK_ABOVE ? (int64_t)(UINT64_MAX >> (64 - bits)) : 0;
}

static int64_t number_of(uint8_t type, const uint8_t *bytes)
{
    const uint32_t size = od_type_size(type);
    const uint64_t number = get_le(bytes, size);
    const unsigned unused = 64 - 8 * size;

    return od_type_signed(type) ? (int64_t)(number << unused) >> unused : (int64_t)number;
}

static bool is_whole_number(uint8_t type)
{
    return (type >= OD_INTEGER8 && type <= OD_UNSIGNED32) ||
           (type >= OD_INTEGER24 && type <= OD_UNSIGNED64 && type != OD_REAL64);
}

/* Files give both limits as 0 where they mean none. */
static bool is_none(const struct dcf_entry *entry)
{
    return entry->low.given && entry->high.given && !entry->low.has_node_id &&
           !entry->high.has_node_id && get_le(entry->low.bytes, entry->low.size) == 0 &&
           get_le(entry->high.bytes, entry->high.size) == 0;
}

bool check_beyond_limit(const struct conform *self, const struct conform_object *object,
                        enum check_side side, uint8_t ret_bytes[8], uint32_t *ret_size)
{
    const struct dcf_entry *entry = object->entry;
    const struct dcf_value *limit;
    int64_t number;

    if (!entry || !is_whole_number(entry->type) || is_none(entry))
        return false;
    limit = side == CHECK_ABOVE ? &entry->high : &entry->low;
    *ret_size = od_type_size(entry->type);
    if (!limit->given || limit->size != *ret_size)
        return false;
    dcf_value(limit, self->options.node, ret_bytes);
    number = number_of(entry->type, ret_bytes);
    if (number == end_of_type(entry->type, side))
        return false;
    put_le(ret_bytes, *ret_size, (uint64_t)number + (side == CHECK_ABOVE ? 1u : UINT64_MAX));
    return true;
}
