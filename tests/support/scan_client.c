#include "support/scan_client.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OPERATIONAL 5

static const char xml[] =
    "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No><Baudrate>500</Baudrate>"
    "<Boot_Delay>0</Boot_Delay><Node_Instance><Node_Id>%d</Node_Id>"
    "<SDO_Timeout>20000</SDO_Timeout></Node_Instance></Manager_Instance></CANopen_Manager>";

void scan_client_start(int node)
{
    FILE *file = fopen("network.xml", "w");
    int state = 0;
    EVENT_T event;

    ck_assert_ptr_nonnull(file);
    fprintf(file, xml, node);
    ck_assert_int_eq(fclose(file), 0);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_msg(mcanOpenConfig("network.xml") == MCANOPEN_OK, "%s", mcanOpenGetErrorText());
    mcanOpenStart();
    while (state != OPERATIONAL) {
        ck_assert_int_eq(mcanOpenEvent(&event, 1), MCANOPEN_OK);
        ck_assert_int_eq(mcanOpenGetNodeState(0, node, &state), MCANOPEN_OK);
    }
}

void scan_client_end(void)
{
    mcanOpenCleanup();
}

uint32_t scan_client_write(int node, int index, const void *bytes, unsigned size, int flags)
{
    ERROR_T error;
    const int result = mcanOpenWriteSDO(0, (unsigned short)node, index, 0, TYP_DOMAIN | flags,
                                        bytes, (int)size, &error);

    ck_assert(result == MCANOPEN_OK || result == MCAL_ABORT_DOMAIN);
    return (uint32_t)error.eclass << 24 | (uint32_t)error.code << 16 | (uint32_t)error.spec << 8 |
           (uint32_t)error.global;
}

void scan_client_expect(int node, int index, const void *bytes, unsigned size, int flags)
{
    void *got = malloc(size + 1u);
    int room = (int)size + 1;

    ck_assert_ptr_nonnull(got);
    ck_assert_int_eq(mcanOpenReadSDO(0, (unsigned short)node, index, flags, got, &room, NULL),
                     MCANOPEN_OK);
    ck_assert_uint_eq((unsigned)room, size);
    ck_assert_mem_eq(got, bytes, size);
    free(got);
}

void scan_talk(struct scan_plant *plant, const char *const *frames, size_t count)
{
    for (size_t i = 0; i < count; i += 2) {
        scan_send(plant, frames[i]);
        scan_expect(plant, frames[i + 1]);
    }
}

void scan_expect_text(struct scan_plant *plant, int node, int index, const char *text)
{
    char got[200];
    unsigned size = sizeof got;

    ck_assert_uint_eq(scan_sdo_upload(plant, node, (unsigned)index, 0, got, &size), 0);
    ck_assert_uint_eq(size, strlen(text));
    ck_assert_mem_eq(got, text, size);
}

uint32_t scan_write_text(struct scan_plant *plant, int node, int index, const char *text)
{
    uint32_t value = 0;

    for (size_t i = strlen(text); i > 0; i--)
        value = value << 8 | (uint8_t)text[i - 1];
    return scan_sdo_write(plant, node, (unsigned)index, 0, (unsigned)strlen(text), value);
}
