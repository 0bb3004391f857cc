/*
 * A device that dies, or resets itself, at each frame of its boot: before the frame is heard, and
 * after. The boot begins anew when it comes back, and ends well.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>

#define FRAMES_MAX 40u

static const char xml[] = PLANT_NODE(4, "")
    PLANT_NODE(5, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
                  "<Device_Type_Identification>0x20192</Device_Type_Identification>"
                  "<Vendor_Identification>0x29A</Vendor_Identification>"
                  "<Serial_Number>5</Serial_Number>"
                  "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"
                  "<Configuration_Date>5000</Configuration_Date>"
                  "<Configuration_Time>6000</Configuration_Time>"
                  "<Save_Configuration>TRUE</Save_Configuration>");

enum fault { DIES_BEFORE, DIES_AFTER, RESETS, RESETS_COMMUNICATION, SAYS_BOOT_UP_TWICE };

struct accident {
    enum fault fault;
    unsigned frame; /* of those between the manager and the device, counted from 0 */
    unsigned count; /* seen so far */
    bool happened;
};

static void happen(struct plant *plant, struct accident *accident)
{
    struct plant_device *device = plant->devices[5];

    accident->happened = true;
    switch (accident->fault) {
    case DIES_BEFORE:
    case DIES_AFTER: sim_power(&plant->sim, device->sim, false); break;
    case RESETS:
        slave_command(&device->slave, NMT_RESET_NODE, plant->sim.now, &device->sim->box);
        sim_touch(&plant->sim, device->sim);
        break;
    case RESETS_COMMUNICATION:
        slave_command(&device->slave, NMT_RESET_COMMUNICATION, plant->sim.now, &device->sim->box);
        sim_touch(&plant->sim, device->sim);
        break;
    case SAYS_BOOT_UP_TWICE:
        sim_say(&plant->sim, "705#00");
        sim_say(&plant->sim, "705#00");
        break;
    }
}

static bool is_of_boot(const struct co_frame *frame)
{
    return frame->id == 0x605 || frame->id == 0x585 || frame->id == 0x705 ||
           (frame->id == NMT_CAN_ID && (frame->data[1] == 0 || frame->data[1] == 5));
}

/* "After" a frame is before the next one: the device has heard or said it. */
static enum sim_fate on_frame(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    struct accident *accident = plant->fault_context;
    bool after = accident->fault != DIES_BEFORE;

    (void)sender;
    if (!is_of_boot(frame) || accident->happened)
        return SIM_DELIVER;
    if (accident->count++ == accident->frame + after)
        happen(plant, accident);
    return SIM_DELIVER;
}

static struct plant *make_plant(struct accident *accident)
{
    struct plant *plant = plant_new(xml, 1000000);
    struct plant_device *device = plant_add_device(plant, 5);

    plant_add_device(plant, 4);
    plant_add_object(device, 0x1010, 0, 1, 1);
    plant_add_object(device, 0x1010, 1, 4, 1);
    plant_add_object(device, 0x1020, 0, 1, 2);
    plant_add_object(device, 0x1020, 1, 4, 0);
    plant_add_object(device, 0x1020, 2, 4, 0);
    plant_add_object(device, 0x6200, 1, 1, 0);
    plant_add_object(device, 0x6200, 2, 4, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    plant_configure(plant, 5, 0x6200, 2, 4, 0x12345678);
    plant_configure(plant, 5, 0x1017, 0, 2, 200);
    plant_configure(plant, 5, 0x1020, 1, 4, 5000);
    plant_configure(plant, 5, 0x1020, 2, 4, 6000);
    snprintf(plant->name, sizeof plant->name, "fault %d at frame %u", accident->fault,
             accident->frame);
    watch_start(plant);
    plant_power_on(plant);
    plant->fault = on_frame;
    plant->fault_context = accident;
    return plant;
}

static void run_accident(enum fault fault, unsigned frame, unsigned off_ms)
{
    struct accident accident = { fault, frame, 0, false };
    struct plant *plant = make_plant(&accident);
    bool dies = fault == DIES_BEFORE || fault == DIES_AFTER;

    plant_run_ms(plant, 1000 + off_ms);
    ck_assert_msg(accident.happened, "%s: there are only %u", plant->name, accident.count);
    if (dies)
        sim_power(&plant->sim, plant->devices[5]->sim, true);
    plant_run_ms(plant, 4000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant->manager->dropped, 0);
    plant_free(plant);
}

/* How many frames there are: each test goes through all of them. */
static unsigned count_frames(void)
{
    struct accident none = { DIES_BEFORE, FRAMES_MAX, 0, false };
    struct plant *plant = make_plant(&none);

    plant_run_ms(plant, 500);
    watch_expect_up(plant, "does not boot");
    plant_free(plant);
    ck_assert_uint_gt(none.count, 20);
    ck_assert_uint_lt(none.count, FRAMES_MAX);
    return none.count - 1;
}

START_TEST(test_dies)
{
    static const unsigned off_ms[] = { 0, 300, 1700, 5000 };
    unsigned frames = count_frames();

    for (unsigned frame = 0; frame < frames; frame++) {
        run_accident(DIES_BEFORE, frame, off_ms[_i]);
        run_accident(DIES_AFTER, frame, off_ms[_i]);
    }
}
END_TEST

START_TEST(test_resets)
{
    unsigned frames = count_frames();

    for (unsigned frame = 0; frame < frames; frame++)
        run_accident((enum fault)_i, frame, 0);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("boot_dies");

    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, test_dies, 0, 4);
    tcase_add_loop_test(tcase, test_resets, RESETS, SAYS_BOOT_UP_TWICE + 1);
    return suite_run("boot_dies", tcase);
}
