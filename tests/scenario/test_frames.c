/*
 * The manager's frames, byte by byte and at their time, where others depend on them.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

static struct plant *make_plant(const char *xml)
{
    struct plant *plant = plant_new(xml, 1000000);

    plant_add_device(plant, 5);
    return plant;
}

/* Of the n-th frame that begins like this, in us since power on; 0: there is none. */
static co_us_t time_of(const struct plant *plant, const char *beginning, unsigned n)
{
    for (size_t i = 0; i < plant->sim.trace_count; i++) {
        char text[CO_FRAME_TEXT_SIZE];

        co_frame_format(&plant->sim.trace[i].frame, text, sizeof text);
        if (strncmp(text, beginning, strlen(beginning)) == 0 && n-- == 0)
            return plant->sim.trace[i].time - CO_MS(1000);
    }
    return 0;
}

/* The frames with this CAN-ID that begin with one of these bytes, in a line each. */
static const char *frames_of(const struct plant *plant, uint32_t id)
{
    static char list[2048];

    list[0] = '\0';
    for (size_t i = 0; i < plant->sim.trace_count; i++) {
        char text[CO_FRAME_TEXT_SIZE];

        if (plant->sim.trace[i].frame.id != id || strlen(list) > sizeof list - sizeof text - 1)
            continue;
        strcat(list, co_frame_format(&plant->sim.trace[i].frame, text, sizeof text));
        strcat(list, "\n");
    }
    return list;
}

/* --- a configuration of all sizes, in its order --- */

static const struct sizes {
    const char *node, *initiate; /* of what has more than four bytes */
} sizes[] = {
    { "", "605#2105620009000000" },
    { "<SDO_Segmented_Size_Indication>FALSE</SDO_Segmented_Size_Indication>",
      "605#2005620000000000" },
};

START_TEST(test_configuration)
{
    static const uint8_t value[9] = { 1, 2, 3, 4, 5, 6, 7, 8, 9 };
    static const struct {
        uint16_t index;
        uint8_t size;
    } entries[] = { { 0x6204, 4 }, { 0x6203, 3 }, { 0x6202, 2 }, { 0x6201, 1 }, { 0x6205, 9 } };
    char xml[256], wanted[512];
    struct plant *plant;

    snprintf(xml, sizeof xml, "<Node_Instance><Node_Id>5</Node_Id>%s</Node_Instance>",
             sizes[_i].node);
    snprintf(wanted, sizeof wanted,
             "605#4000100000000000\n605#2304620001020304\n605#2703620001020300\n"
             "605#2B02620001020000\n605#2F01620001000000\n%s\n605#0001020304050607\n"
             "605#1B08090000000000\n",
             sizes[_i].initiate);
    plant = make_plant(xml);
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
        const struct od_spec spec = {
            .index = entries[i].index, .type = OD_OCTET_STRING, .access = OD_RW, .capacity = 9
        };

        ck_assert_int_eq(od_add(&plant->devices[5]->od, &spec, NULL), CO_OK);
        ck_assert_int_eq(
            ccf_append(&plant->config->nodes[0].ccf, entries[i].index, 0, value, entries[i].size),
            CO_OK);
    }
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_str_eq(frames_of(plant, 0x605), wanted);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* --- a node that does not answer --- */

/* Each try its whole time, then the server is told; a second after the last one, all again. */
START_TEST(test_no_answer)
{
    struct plant *plant = make_plant(PLANT_NODE(5, ""));
    co_us_t first;

    plant_lie(plant, "605#", NULL, 1000);
    plant_power_on(plant);
    plant_run_ms(plant, 3000);
    first = time_of(plant, "605#4000100000000000", 0);
    ck_assert_uint_eq(first, CO_MS(200) + 135); /* when it is on the wire */
    for (unsigned i = 0; i < 3; i++) {
        co_us_t asked = time_of(plant, "605#4000100000000000", i);
        co_us_t told = time_of(plant, "605#8000100000000405", i);

        ck_assert_uint_ge(told, asked + CO_MS(200));
        ck_assert_uint_le(told, asked + CO_MS(200) + 300);
        ck_assert_uint_ge(asked, first + i * CO_MS(200));
        ck_assert_uint_le(asked, first + i * CO_MS(200) + i * 600u);
    }
    ck_assert_uint_ge(time_of(plant, "605#4000100000000000", 3), first + CO_MS(1600));
    ck_assert_uint_le(time_of(plant, "605#4000100000000000", 3), first + CO_MS(1602));
    plant_free(plant);
}
END_TEST

/* --- the manager as a device --- */

/* Its boot-up message is the first frame of all, and its heartbeat tells its state all the time. */
START_TEST(test_own_heartbeat)
{
    struct plant *plant = make_plant(
        "<Heartbeat_Producer_Time>150</Heartbeat_Producer_Time>" PLANT_NODE(
            5, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"));

    plant_lie(plant, "605#4000", NULL, 2);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant->sim.trace[0].frame.id, 0x77F);
    ck_assert_str_eq(frames_of(plant, 0x77F),
                     "77F#00\n77F#7F\n77F#7F\n77F#7F\n77F#7F\n77F#05\n77F#05\n");
    for (unsigned i = 0; i < 4; i++)
        ck_assert_uint_le(time_of(plant, "77F#7F", i) - (i + 1) * CO_MS(150), 500);
    ck_assert_int_eq(plant_command(plant, NMT_STOP, 127), CO_OK);
    plant_run_ms(plant, 200);
    ck_assert_uint_ge(plant_sent(plant, "77F#04"), 1);
    plant_free(plant);
}
END_TEST

START_TEST(test_no_own_heartbeat)
{
    struct plant *plant = make_plant(PLANT_NODE(5, ""));

    plant_power_on(plant);
    plant_run_ms(plant, 5000);
    ck_assert_str_eq(frames_of(plant, 0x77F), "77F#00\n");
    plant_free(plant);
}
END_TEST

/* --- a node that restarts in operation --- */

/* While it boots nobody guards it, and its silence is no loss; then it is guarded as before. */
static enum sim_fate answer_slowly(struct plant *plant, const struct co_frame *frame,
                                   uint8_t sender)
{
    (void)sender;
    if (frame->id == 0x605)
        plant->devices[5]->sim->hold_until = plant->sim.now + CO_MS(800);
    return SIM_DELIVER;
}

START_TEST(test_restart_in_operation)
{
    struct plant *plant = make_plant(
        PLANT_NODE(5, "<Guard_Time>100</Guard_Time><Life_Time_Factor>2</Life_Time_Factor>"
                      "<SDO_Timeout>1000</SDO_Timeout>"));
    unsigned asked;

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    plant->fault = answer_slowly;
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 10);
    asked = plant_sent(plant, "705#R");
    plant_run_ms(plant, 700);
    ck_assert_uint_eq(plant_sent(plant, "705#R"), asked);
    plant->fault = NULL;
    plant_run_ms(plant, 1000);
    ck_assert_uint_ge(plant_sent(plant, "705#R"), asked + 7);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    ck_assert(!plant_said(plant, "no answer to guarding"));
    ck_assert_uint_eq(plant_sent(plant, "000#8"), 1); /* of the beginning */
    plant_free(plant);
}
END_TEST

/* What fits into one frame goes in one, blocks or not; five bytes do not. */
START_TEST(test_small_values_without_blocks)
{
    static const uint8_t value[5] = { 1, 2, 3, 4, 5 };
    struct plant *plant = make_plant(PLANT_NODE(5, "<SDO_Block_Size>16</SDO_Block_Size>"));

    for (uint8_t size = 4; size <= 5; size++) {
        const struct od_spec spec = { .index = (uint16_t)(0x6200 + size),
                                      .type = OD_OCTET_STRING,
                                      .access = OD_RW,
                                      .capacity = 5 };

        ck_assert_int_eq(od_add(&plant->devices[5]->od, &spec, NULL), CO_OK);
        ck_assert_int_eq(ccf_append(&plant->config->nodes[0].ccf, spec.index, 0, value, size),
                         CO_OK);
    }
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_ptr_nonnull(strstr(frames_of(plant, 0x605), "605#2304620001020304\n"));
    ck_assert_ptr_nonnull(strstr(frames_of(plant, 0x605), "605#C605620005000000\n"));
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("frames");

    tcase_add_loop_test(tcase, test_configuration, 0, 2);
    tcase_add_test(tcase, test_no_answer);
    tcase_add_test(tcase, test_own_heartbeat);
    tcase_add_test(tcase, test_no_own_heartbeat);
    tcase_add_test(tcase, test_restart_in_operation);
    tcase_add_test(tcase, test_small_values_without_blocks);
    return suite_run("frames", tcase);
}
