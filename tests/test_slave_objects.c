/* What a local device refuses to have written to its communication objects, and why. */
#include "slave/slave.h"

#include "base/bytes.h"
#include "support/device.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

#define OFF 0x80000000u

static const struct device_entry entries[] = {
    { 0x1003, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1003, 1, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1005, 0, OD_UNSIGNED32, OD_RW, 0x80, false },
    { 0x1006, 0, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1007, 0, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x100C, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x100D, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1010, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1010, 1, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1011, 1, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1012, 0, OD_UNSIGNED32, OD_RW, 0x100, false },
    { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
    { 0x1015, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1016, 0, OD_UNSIGNED8, OD_RW, 2, false },
    { 0x1016, 1, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1016, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1017, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1019, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1028, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1028, 1, OD_UNSIGNED32, OD_RW, OFF, false },
    { 0x1029, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1029, 1, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1200, 0, OD_UNSIGNED8, OD_CONST, 2, false },
    { 0x1200, 1, OD_UNSIGNED32, OD_RW, 0x605, false },
    { 0x1200, 2, OD_UNSIGNED32, OD_RO, 0x585, false },
    { 0x1201, 1, OD_UNSIGNED32, OD_RW, OFF, false },
    { 0x1201, 2, OD_UNSIGNED32, OD_RW, OFF, false },
    { 0x1201, 3, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1280, 1, OD_UNSIGNED32, OD_RW, OFF, false },
    { 0x1280, 2, OD_UNSIGNED32, OD_RW, OFF, false },
    { 0x1281, 1, OD_UNSIGNED32, OD_RW, 0, false }, /* not switched off, and the same twice */
    { 0x1281, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1400, 0, OD_UNSIGNED8, OD_CONST, 2, false },
    { 0x1400, 1, OD_UNSIGNED32, OD_RW, 0x205, false },
    { 0x1400, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1400, 3, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1401, 1, OD_UNSIGNED32, OD_RW, 0xC0000305, false },
    { 0x1600, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1600, 1, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1600, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1600, 3, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1601, 0, OD_UNSIGNED8, OD_CONST, 2, false },
    { 0x1601, 1, OD_UNSIGNED32, OD_RW, 0x20030010, false },
    { 0x1601, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1800, 0, OD_UNSIGNED8, OD_CONST, 6, false },
    { 0x1800, 1, OD_UNSIGNED32, OD_RW, 0x185, false },
    { 0x1800, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1800, 3, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1800, 5, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1800, 6, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1801, 1, OD_UNSIGNED32, OD_RW, 0xC0000000, false },
    { 0x1801, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1A00, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1A00, 1, OD_UNSIGNED32, OD_RW, 0x20060010, false },
    { 0x1A00, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1A00, 3, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1402, 1, OD_UNSIGNED32, OD_RO, 0x405, false }, /* cannot be switched off */
    { 0x1602, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1602, 1, OD_UNSIGNED32, OD_RW, 0x20000020, false },
    { 0x1403, 1, OD_UNSIGNED32, OD_RW, 0x181, false },
    { 0x1804, 1, OD_UNSIGNED32, OD_RW, 0x180, false }, /* a restricted identifier */
    { 0x1A05, 0, OD_UNSIGNED8, OD_RW, 0, false },      /* without 1805h */
    { 0x1A05, 1, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x2000, 0, OD_UNSIGNED32, OD_RWW, 0, true },
    { 0x2001, 0, OD_UNSIGNED32, OD_RWR, 0, true },
    { 0x2002, 0, OD_UNSIGNED8, OD_RO, 0, true },
    { 0x2003, 0, OD_UNSIGNED16, OD_WO, 0, true },
    { 0x2004, 0, OD_BOOLEAN, OD_RW, 0, true },
    { 0x2005, 1, OD_UNSIGNED64, OD_RW, 0, true },
    { 0x2006, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x2007, 0, OD_VISIBLE_STRING, OD_RW, 0, true },
    { 0 },
};

static struct device device;

static void setup(void)
{
    device_init(&device, entries);
    device_start(&device);
    device_forget(&device);
}

static void teardown(void)
{
    device_done(&device);
}

#define LOAD 0x64616F6C
#define SAVE 0x65766173

static const struct {
    uint16_t index;
    uint8_t sub, size;
    uint32_t value;
    sdo_abort_t code;
} writes[] = {
    /* The server's own checks. */
    { 0x1000, 0, 4, 1, SDO_READ_ONLY },
    { 0x1000, 1, 4, 1, SDO_NO_SUB },
    { 0x1004, 0, 4, 1, SDO_NO_OBJECT },
    { 0x1017, 0, 4, 1, SDO_TOO_LONG },
    { 0x1006, 0, 1, 1, SDO_TOO_SHORT },
    /* Error history. */
    { 0x1003, 0, 1, 0, SDO_OK },
    { 0x1003, 0, 1, 1, SDO_INVALID_VALUE },
    { 0x1003, 0, 1, 255, SDO_INVALID_VALUE },
    { 0x1003, 0, 4, 0, SDO_TOO_LONG },
    { 0x1003, 1, 4, 0, SDO_READ_ONLY },
    /* SYNC. */
    { 0x1005, 0, 4, 0x81, SDO_OK },
    { 0x1005, 0, 4, 0x40000090, SDO_OK },
    { 0x1005, 0, 4, 0x80000080, SDO_OK },
    { 0x1005, 0, 4, 0x7F, SDO_INVALID_VALUE },
    { 0x1005, 0, 4, 0x20000080, SDO_OK },
    { 0x1005, 0, 4, 0x3FFFFFFF, SDO_OK },
    { 0x1005, 0, 4, 0x205, SDO_INVALID_VALUE }, /* taken by an RPDO */
    { 0x1005, 0, 4, 0x00000880, SDO_INVALID_VALUE },
    { 0x1005, 0, 4, 0x10000080, SDO_INVALID_VALUE },
    { 0x1006, 0, 4, 0xFFFFFFFF, SDO_OK },
    { 0x1007, 0, 4, 0xFFFFFFFF, SDO_OK },
    { 0x1019, 0, 1, 1, SDO_INVALID_VALUE },
    { 0x1019, 0, 1, 2, SDO_OK },
    { 0x1019, 0, 1, 240, SDO_OK },
    { 0x1019, 0, 1, 241, SDO_INVALID_VALUE },
    { 0x1019, 0, 1, 0, SDO_OK },
    { 0x100C, 0, 2, 0xFFFF, SDO_OK },
    { 0x100D, 0, 1, 0xFF, SDO_OK },
    /* Signatures; the byte-swapped one too. */
    { 0x1010, 1, 4, SAVE, SDO_OK },
    { 0x1010, 1, 4, 0x6E6F7277, SDO_NOT_STORED },
    { 0x1010, 1, 4, 0x73617665, SDO_NOT_STORED },
    { 0x1010, 1, 4, LOAD, SDO_NOT_STORED },
    { 0x1010, 0, 1, 1, SDO_READ_ONLY },
    { 0x1011, 1, 4, LOAD, SDO_OK },
    { 0x1011, 1, 4, SAVE, SDO_NOT_STORED },
    { 0x1011, 1, 4, 0, SDO_NOT_STORED },
    /* TIME, EMCY. */
    { 0x1012, 0, 4, 0x181, SDO_OK },
    { 0x1012, 0, 4, 0x101, SDO_INVALID_VALUE },
    { 0x1012, 0, 4, 0x80000000, SDO_INVALID_VALUE },
    { 0x1014, 0, 4, 0x85, SDO_OK },
    { 0x1014, 0, 4, 0x86, SDO_INVALID_VALUE },
    { 0x1014, 0, 4, OFF, SDO_OK },
    { 0x1014, 0, 4, 0x40000085, SDO_INVALID_VALUE },
    { 0x1014, 0, 4, 0xC0000085, SDO_INVALID_VALUE },
    { 0x1015, 0, 2, 0xFFFF, SDO_OK },
    { 0x1028, 0, 1, 1, SDO_OK },
    { 0x1028, 1, 4, 0x81, SDO_OK },
    { 0x1028, 1, 4, 0x7F, SDO_INVALID_VALUE },
    { 0x1028, 1, 4, 0xC0000081, SDO_INVALID_VALUE },
    /* Error control. */
    { 0x1016, 0, 1, 2, SDO_OK },
    { 0x1016, 1, 4, 0x00071234, SDO_OK },
    { 0x1017, 0, 2, 0xFFFF, SDO_OK },
    { 0x1029, 0, 1, 1, SDO_OK },
    { 0x1029, 1, 1, 2, SDO_OK },
    { 0x1029, 1, 1, 3, SDO_INVALID_VALUE },
    { 0x1029, 1, 1, 127, SDO_INVALID_VALUE },
    { 0x1029, 1, 1, 128, SDO_OK },
    /* SDO channels. */
    { 0x1200, 1, 4, 0x605, SDO_OK },
    { 0x1200, 1, 4, 0x606, SDO_READ_ONLY },
    { 0x1200, 2, 4, 0x585, SDO_READ_ONLY },
    { 0x1201, 1, 4, 0x600, SDO_OK },
    { 0x1201, 1, 4, 0x605, SDO_INVALID_VALUE },
    { 0x1201, 1, 4, 0x80000605, SDO_OK },
    { 0x1201, 3, 1, 5, SDO_OK },
    { 0x1280, 1, 4, 0x607, SDO_OK },
    { 0x1280, 1, 4, 0x587, SDO_OK },
    { 0x1280, 1, 4, 0x707, SDO_INVALID_VALUE },
    { 0x1280, 1, 4, 0x20000607, SDO_INVALID_VALUE },
    { 0x1281, 1, 4, 0, SDO_OK },
    { 0x1281, 2, 4, 0, SDO_OK },
    /* PDO communication parameters. */
    { 0x1400, 1, 4, 0x205, SDO_OK },
    { 0x1400, 1, 4, 0x206, SDO_INVALID_VALUE },
    { 0x1400, 1, 4, 0x40000205, SDO_INVALID_VALUE },
    { 0x1400, 1, 4, 0xC0000205, SDO_INVALID_VALUE },
    { 0x1400, 1, 4, 0x20000205, SDO_INVALID_VALUE },
    { 0x1400, 1, 4, OFF, SDO_OK },
    { 0x1401, 1, 4, 0x305, SDO_OK },
    { 0x1401, 1, 4, 0x205, SDO_OK }, /* RPDOs share one */
    { 0x1401, 1, 4, 0x2000007F, SDO_OK },
    { 0x1401, 1, 4, 0x3FFFFFFF, SDO_OK },
    { 0x1401, 1, 4, 0x1FFFFFFF, SDO_INVALID_VALUE },
    { 0x1401, 1, 4, 0x185, SDO_INVALID_VALUE },
    { 0x1401, 1, 4, 0x80, SDO_INVALID_VALUE },
    { 0x1401, 1, 4, 0x85, SDO_INVALID_VALUE },
    { 0x1401, 1, 4, 0x80000185, SDO_OK },
    { 0x1400, 2, 1, 0, SDO_OK },
    { 0x1400, 2, 1, 240, SDO_OK },
    { 0x1400, 2, 1, 241, SDO_INVALID_VALUE },
    { 0x1400, 2, 1, 253, SDO_INVALID_VALUE },
    { 0x1400, 2, 1, 254, SDO_OK },
    { 0x1400, 3, 2, 100, SDO_OK },
    { 0x1400, 4, 1, 0, SDO_NO_SUB },
    { 0x1401, 1, 4, 0x40000305, SDO_OK },
    { 0x1800, 1, 4, 0x186, SDO_INVALID_VALUE },
    { 0x1800, 1, 4, 0x40000185, SDO_OK },
    { 0x1800, 1, 4, 0xC0000185, SDO_OK },
    { 0x1800, 2, 1, 240, SDO_OK },
    { 0x1800, 2, 1, 241, SDO_INVALID_VALUE },
    { 0x1800, 2, 1, 251, SDO_INVALID_VALUE },
    { 0x1800, 2, 1, 252, SDO_OK },
    { 0x1800, 2, 1, 253, SDO_OK },
    { 0x1800, 2, 1, 254, SDO_OK },
    { 0x1800, 3, 2, 10, SDO_INVALID_VALUE },
    { 0x1800, 4, 1, 0, SDO_NO_SUB },
    { 0x1800, 5, 2, 10, SDO_OK },
    { 0x1800, 6, 1, 1, SDO_INVALID_VALUE },
    { 0x1801, 1, 4, 0x40000285, SDO_OK },
    { 0x1801, 1, 4, 0x40000000, SDO_INVALID_VALUE },
    { 0x1801, 1, 4, 0x20000285, SDO_OK },
    { 0x1801, 1, 4, 0x185, SDO_INVALID_VALUE },
    { 0x1801, 1, 4, 0x205, SDO_INVALID_VALUE },
    { 0x1801, 1, 4, 0x40000205, SDO_INVALID_VALUE },
    { 0x1801, 1, 4, 0x100, SDO_OK }, /* TIME is not in use */
    { 0x1801, 2, 1, 252, SDO_INVALID_VALUE },
    { 0x1801, 2, 1, 253, SDO_INVALID_VALUE },
    /* Mapping of PDOs that are valid. */
    { 0x1600, 0, 1, 0, SDO_ACCESS },
    { 0x1600, 1, 4, 0x20000020, SDO_ACCESS },
    { 0x1A00, 0, 1, 0, SDO_ACCESS },
    { 0x1A00, 1, 4, 0x20010020, SDO_ACCESS },
    { 0x1A05, 1, 4, 0x20010020, SDO_OK },
    { 0x1601, 0, 1, 0, SDO_READ_ONLY },
};

START_TEST(one_write)
{
    uint32_t before = 0, after = 0;
    const sdo_abort_t readable = device_read(&device, writes[_i].index, writes[_i].sub, &before);
    const sdo_abort_t code = device_write(&device, writes[_i].index, writes[_i].sub,
                                          writes[_i].size, writes[_i].value);
    const bool is_command = (writes[_i].index & 0xFFFE) == 0x1010;

    ck_assert_msg(code == writes[_i].code, "%04X:%02X = %X: %08X, expected %08X", writes[_i].index,
                  writes[_i].sub, writes[_i].value, code, writes[_i].code);
    ck_assert_str_eq(device_next_event(&device)[0] == '\0' ? "" : "written",
                     code == SDO_OK ? "written" : "");
    if (readable != SDO_OK)
        return;
    ck_assert_uint_eq(device_read(&device, writes[_i].index, writes[_i].sub, &after), SDO_OK);
    ck_assert_uint_eq(after, code == SDO_OK && !is_command ? writes[_i].value : before);
}
END_TEST

static bool is_restricted(uint32_t id)
{
    return id < 0x80 || (id > 0x100 && id < 0x181) || (id > 0x580 && id < 0x600) ||
           (id > 0x600 && id < 0x680) || (id >= 0x6E0 && id < 0x700) || id > 0x700;
}

/* Identifiers of the other objects; RPDOs may have that of another RPDO. */
static bool is_taken(uint16_t index, uint32_t id)
{
    static const struct {
        uint16_t index;
        uint32_t id;
    } users[] = { { 0x1005, 0x80 },  { 0x1014, 0x85 },  { 0x1400, 0x205 }, { 0x1402, 0x405 },
                  { 0x1403, 0x181 }, { 0x1800, 0x185 }, { 0x1804, 0x180 } };

    if (index == 0x1028 || index == 0x1012) /* what others send; not in use */
        return false;
    for (size_t i = 0; i < sizeof users / sizeof users[0]; i++)
        if (users[i].id == id && users[i].index != index &&
            !(index == 0x1400 && users[i].index < 0x1600 && users[i].index >= 0x1400))
            return true;
    return false;
}

/* All identifiers, on each object that has one. */
START_TEST(restricted_can_ids)
{
    static const struct {
        uint16_t index;
        uint8_t sub;
        bool switched; /* bit 31 first */
    } objects[] = { { 0x1005, 0, false }, { 0x1012, 0, true }, { 0x1014, 0, true },
                    { 0x1028, 1, true },  { 0x1400, 1, true }, { 0x1800, 1, true },
                    { 0x1201, 1, true },  { 0x1201, 2, true } };
    const uint16_t index = objects[_i].index;
    const uint8_t sub = objects[_i].sub;

    for (uint32_t id = 0; id < 0x800; id++) {
        /* TIME is off without both its bits, the others with bit 31. */
        const uint32_t off = index == 0x1012 ? 0x100 : OFF;

        if (objects[_i].switched)
            ck_assert_uint_eq(device_write(&device, index, sub, 4, off), SDO_OK);
        ck_assert_msg(device_write(&device, index, sub, 4, id) ==
                          (is_restricted(id) || is_taken(index, id) ? SDO_INVALID_VALUE : SDO_OK),
                      "%04X: CAN-ID %03X", index, id);
        device_forget(&device);
    }
}
END_TEST

struct step {
    uint16_t index;
    uint8_t sub, size;
    uint32_t value;
    sdo_abort_t code;
};

#define STEPS 20

/* clang-format off */
static const struct {
    const char *name;
    struct step steps[STEPS];
} sequences[] = {
    { "SYNC is off while its CAN-ID changes",
      { { 0x1005, 0, 4, 0x40000080, SDO_OK }, { 0x1005, 0, 4, 0x40000090, SDO_INVALID_VALUE },
        { 0x1005, 0, 4, 0x40000080, SDO_OK }, { 0x1005, 0, 4, 0x00000090, SDO_OK },
        { 0x1005, 0, 4, 0x40000090, SDO_OK } } },
    { "TIME: consumer or producer",
      { { 0x1012, 0, 4, 0x80000100, SDO_OK }, { 0x1012, 0, 4, 0x80000181, SDO_INVALID_VALUE },
        { 0x1012, 0, 4, 0x40000181, SDO_INVALID_VALUE }, { 0x1012, 0, 4, 0x181, SDO_OK },
        { 0x1012, 0, 4, 0xC0000181, SDO_INVALID_VALUE }, /* RPDO 4 has it */
        { 0x1012, 0, 4, 0xC0000182, SDO_OK }, { 0x1012, 0, 4, 0x40000182, SDO_OK },
        { 0x1401, 1, 4, 0x182, SDO_INVALID_VALUE }, { 0x1012, 0, 4, 0x182, SDO_OK },
        { 0x1401, 1, 4, 0x182, SDO_OK } } },
    { "the SYNC counter while SYNC is produced",
      { { 0x1006, 0, 4, 1000, SDO_OK }, { 0x1019, 0, 1, 1, SDO_INVALID_VALUE },
        { 0x1019, 0, 1, 10, SDO_DEVICE_STATE }, { 0x1006, 0, 4, 0, SDO_OK },
        { 0x1019, 0, 1, 10, SDO_OK } } },
    { "the same node watched twice",
      { { 0x1016, 1, 4, 0x00051234, SDO_OK }, { 0x1016, 2, 4, 0x00051234, SDO_PARAMETER },
        { 0x1016, 2, 4, 0x00050001, SDO_PARAMETER }, { 0x1016, 2, 4, 0x00050000, SDO_OK },
        { 0x1016, 1, 4, 0x00051235, SDO_OK }, { 0x1016, 2, 4, 0x00061234, SDO_OK },
        { 0x1016, 1, 4, 0, SDO_OK }, { 0x1016, 2, 4, 0x00051234, SDO_OK },
        { 0x1016, 1, 4, 0x00001234, SDO_OK }, { 0x1016, 2, 4, 0x00001234, SDO_OK },
        { 0x1016, 1, 4, 0x00801234, SDO_OK }, { 0x1016, 2, 4, 0x00801234, SDO_OK } } },
    { "an SDO channel is frozen when both directions are there",
      { { 0x1201, 1, 4, 0x680, SDO_OK }, { 0x1201, 1, 4, 0x681, SDO_OK },
        { 0x1201, 2, 4, 0x682, SDO_OK }, { 0x1201, 2, 4, 0x683, SDO_INVALID_VALUE },
        { 0x1201, 1, 4, 0x684, SDO_INVALID_VALUE }, { 0x1201, 1, 4, 0x681, SDO_OK },
        { 0x1201, 1, 4, 0x80000681, SDO_OK }, { 0x1201, 2, 4, 0x683, SDO_OK } } },
    { "a PDO is off while its parameters change",
      { { 0x1800, 1, 4, 0x80000185, SDO_OK }, { 0x1800, 3, 2, 10, SDO_OK },
        { 0x1800, 6, 1, 240, SDO_OK }, { 0x1800, 6, 1, 241, SDO_INVALID_VALUE },
        { 0x1801, 1, 4, 0x185, SDO_OK }, { 0x1800, 1, 4, 0x285, SDO_OK },
        { 0x1800, 3, 2, 11, SDO_INVALID_VALUE },
        { 0x1800, 2, 1, 1, SDO_OK } } },
    { "mapping, step by step",
      { { 0x1400, 1, 4, 0x80000205, SDO_OK }, { 0x1600, 0, 1, 0, SDO_OK },
        { 0x1600, 1, 4, 0x20000020, SDO_OK }, { 0x1600, 2, 4, 0x20030010, SDO_OK },
        { 0x1600, 0, 1, 2, SDO_OK }, { 0x1600, 1, 4, 0x20030010, SDO_ACCESS },
        { 0x1600, 1, 4, 0, SDO_ACCESS }, { 0x1600, 0, 1, 1, SDO_OK },
        { 0x1400, 1, 4, 0x205, SDO_OK }, { 0x1600, 0, 1, 0, SDO_ACCESS } } },
    { "what an RPDO can take",
      { { 0x1400, 1, 4, OFF, SDO_OK },
        { 0x1600, 1, 4, 0x3FFF0020, SDO_NO_OBJECT }, { 0x1600, 1, 4, 0x20000120, SDO_NO_SUB },
        { 0x1600, 1, 4, 0x20010020, SDO_NOT_MAPPABLE }, /* rwr */
        { 0x1600, 1, 4, 0x20020008, SDO_NOT_MAPPABLE }, /* ro */
        { 0x1600, 1, 4, 0x20060010, SDO_NOT_MAPPABLE }, /* PDOMapping=0 */
        { 0x1600, 1, 4, 0x20070040, SDO_NOT_MAPPABLE }, /* string */
        { 0x1600, 1, 4, 0x20070000, SDO_NOT_MAPPABLE },
        { 0x1600, 1, 4, 0x20000010, SDO_NOT_MAPPABLE }, /* length */
        { 0x1600, 1, 4, 0x20000000, SDO_NOT_MAPPABLE },
        { 0x1600, 1, 4, 0x20030010, SDO_OK }, /* wo */
        { 0x1600, 2, 4, 0x20040001, SDO_OK }, { 0x1600, 3, 4, 0x20040008, SDO_OK },
        { 0x1600, 3, 4, 0x20050140, SDO_OK }, { 0x1600, 3, 4, 0, SDO_OK },
        { 0x1600, 0, 1, 2, SDO_OK } } },
    { "what a TPDO can take",
      { { 0x1800, 1, 4, OFF, SDO_OK }, { 0x1A00, 0, 1, 0, SDO_OK },
        { 0x1A00, 2, 4, 0x20000020, SDO_NOT_MAPPABLE }, /* rww */
        { 0x1A00, 2, 4, 0x20030010, SDO_NOT_MAPPABLE }, /* wo */
        { 0x1A00, 2, 4, 0x20020008, SDO_OK }, { 0x1A00, 2, 4, 0x20010020, SDO_OK },
        { 0x1A00, 2, 4, 0x20040001, SDO_OK },
        { 0x1A00, 2, 4, 0x00050008, SDO_NOT_MAPPABLE }, /* dummy */
        { 0x1A00, 0, 1, 2, SDO_OK } } },
    { "dummies in an RPDO",
      { { 0x1400, 1, 4, OFF, SDO_OK }, { 0x1600, 1, 4, 0x00020008, SDO_OK },
        { 0x1600, 1, 4, 0x00010001, SDO_OK }, { 0x1600, 1, 4, 0x00060010, SDO_OK },
        { 0x1600, 1, 4, 0x00070010, SDO_NOT_MAPPABLE }, { 0x1600, 1, 4, 0x00070120, SDO_NO_SUB },
        { 0x1600, 1, 4, 0x00000008, SDO_NO_OBJECT }, { 0x1600, 1, 4, 0x00090008, SDO_NO_OBJECT },
        { 0x1600, 1, 4, 0x001C0008, SDO_NO_OBJECT }, { 0x1600, 0, 1, 1, SDO_OK } } },
    { "too much for a PDO",
      { { 0x1400, 1, 4, OFF, SDO_OK }, { 0x1600, 1, 4, 0x20000020, SDO_OK },
        { 0x1600, 2, 4, 0x20000020, SDO_OK }, { 0x1600, 3, 4, 0x20040001, SDO_OK },
        { 0x1600, 0, 1, 3, SDO_PDO_LENGTH }, { 0x1600, 0, 1, 2, SDO_OK },
        { 0x1600, 0, 1, 0, SDO_OK }, { 0x1600, 0, 1, 4, SDO_PDO_LENGTH },
        { 0x1600, 0, 1, 65, SDO_PDO_LENGTH }, { 0x1600, 0, 1, 254, SDO_PDO_LENGTH } } },
    { "an entry that is counted must be one",
      { { 0x1400, 1, 4, OFF, SDO_OK }, { 0x1600, 1, 4, 0x20000020, SDO_OK },
        { 0x1600, 0, 1, 2, SDO_NO_OBJECT }, { 0x1600, 0, 1, 1, SDO_OK } } },
    { "a default mapping is right, whatever the object says",
      { { 0x1800, 1, 4, OFF, SDO_OK }, { 0x1A00, 0, 1, 0, SDO_OK },
        { 0x1A00, 1, 4, 0x20010020, SDO_OK }, { 0x1A00, 1, 4, 0x20060010, SDO_OK },
        { 0x1A00, 0, 1, 1, SDO_OK } } },
    { "a PDO that cannot be switched off is mapped while it is valid",
      { { 0x1402, 1, 4, OFF, SDO_READ_ONLY }, { 0x1602, 1, 4, 0x20030010, SDO_ACCESS },
        { 0x1602, 0, 1, 0, SDO_OK }, { 0x1602, 1, 4, 0x20030010, SDO_OK },
        { 0x1602, 0, 1, 1, SDO_OK } } },
    { "a default CAN-ID is right, restricted or not",
      { { 0x1804, 1, 4, 0x80000180, SDO_OK }, { 0x1804, 1, 4, 0x17F, SDO_INVALID_VALUE },
        { 0x1804, 1, 4, 0x180, SDO_OK }, { 0x1804, 1, 4, 0x17F, SDO_INVALID_VALUE },
        { 0x1403, 1, 4, OFF, SDO_OK }, { 0x1403, 1, 4, 0x180, SDO_INVALID_VALUE } } },
    { "a mapping with a fixed count is changed in place",
      { { 0x1601, 1, 4, 0x20000020, SDO_OK }, { 0x1601, 2, 4, 0x20030010, SDO_OK },
        { 0x1601, 2, 4, 0x20010020, SDO_NOT_MAPPABLE } } },
};
/* clang-format on */

START_TEST(sequence)
{
    const struct step *step = sequences[_i].steps;

    for (; step < sequences[_i].steps + STEPS && step->index != 0; step++) {
        const sdo_abort_t code = device_write(&device, step->index, step->sub, step->size,
                                              step->value);

        ck_assert_msg(code == step->code, "%s: %04X:%02X = %X: %08X, expected %08X",
                      sequences[_i].name, step->index, step->sub, step->value, code, step->code);
    }
}
END_TEST

/* Limits of real EDS files, which would turn "wrong signature" into "value too low". */
START_TEST(limits_of_signatures)
{
    const uint8_t one[] = { 1, 0, 0, 0 };
    const struct od_spec spec = { .index = 0x1010,
                                  .sub = 1,
                                  .type = OD_UNSIGNED32,
                                  .access = OD_RW,
                                  .has_low = true,
                                  .has_high = true,
                                  .low = SAVE,
                                  .high = SAVE,
                                  .value = one,
                                  .size = 4 };
    struct device other;
    struct od od;

    od_init(&od);
    ck_assert_int_eq(od_add(&od, &spec, NULL), CO_OK);
    device_init_od(&other, &od);
    device_start(&other);
    ck_assert_uint_eq(device_write(&other, 0x1010, 1, 4, 0x6E6F7277), SDO_NOT_STORED);
    ck_assert_uint_eq(device_write(&other, 0x1010, 1, 4, SAVE), SDO_OK);
    ck_assert_uint_eq(device_value(&other, 0x1010, 1), 1);
    device_done(&other);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("slave_objects");
    TCase *tcase = tcase_create("slave_objects");

    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, one_write, 0, (int)(sizeof writes / sizeof writes[0]));
    tcase_add_loop_test(tcase, restricted_can_ids, 0, 8);
    tcase_add_loop_test(tcase, sequence, 0, (int)(sizeof sequences / sizeof sequences[0]));
    tcase_add_test(tcase, limits_of_signatures);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(make_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
