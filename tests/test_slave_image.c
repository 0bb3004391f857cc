/* 1010h, 1011h with an owner who keeps the power-on values: images, and taking them back. */
#include "slave/slave_store.h"

#include "support/guarded.h"
#include "support/hex.h"
#include "support/saver.h"
#include "support/suite.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

static void verify(uint32_t date, uint32_t time)
{
    saver_put(0x1020, 1, 4, date);
    saver_put(0x1020, 2, 4, time);
}

/* The last question's transfer. */
static struct slave_transfer asked(void)
{
    struct slave_transfer transfer = { 0, 0 };

    for (unsigned i = 0; i < saver_device.event_count; i++)
        if (saver_device.events[i].type == SLAVE_VERDICT)
            transfer = (struct slave_transfer){ saver_device.events[i].detail,
                                                saver_device.events[i].code };
    ck_assert_uint_ne(transfer.number, 0);
    return transfer;
}

static struct slave_transfer order(uint16_t index, uint8_t sub)
{
    od_find(&saver_device.od, index, sub)->watched = true;
    ck_assert_uint_eq(device_write(&saver_device, index, sub, 4, index == 0x1010 ? SAVE : LOAD),
                      DEVICE_SILENT);
    return asked();
}

static void expect_image(const struct ccf *image, const char *text)
{
    char got[400] = "", *end = got;
    struct ccf_reader reader;
    struct ccf_entry value;

    ccf_reader_init(&reader, image);
    while (ccf_read(&reader, &value)) {
        end += sprintf(end, "%04X:%02X=", value.index, value.sub);
        hex_format(value.value, value.size, end, (size_t)(got + sizeof got - end));
        end += strlen(end);
        *end++ = ' ';
        *end = '\0';
    }
    ck_assert_str_eq(got, text);
}

static void begin(struct slave_transfer transfer, struct slave_store *store)
{
    ck_assert_int_eq(slave_begin_store(&saver_device.slave, transfer, saver_device.now, store),
                     CO_OK);
}

/* The whole way; the answer, "" for none. */
static const char *finish(struct slave_transfer transfer, struct slave_store *store)
{
    device_forget(&saver_device);
    slave_end_store(&saver_device.slave, store);
    slave_free_store(store);
    slave_verdict(&saver_device.slave, transfer, SLAVE_DONE, saver_device.now, &saver_device.out);
    device_drain(&saver_device);
    return device_next_frame(&saver_device, NULL);
}

#define COMMUNICATION "1006:00=57040000 "
#define MANUFACTURER  "2000:00=AE08 "
#define APPLICATION   "6000:00=0A1A "
#define VERIFIED      "1020:01=01000000 1020:02=02000000 "

static const struct {
    uint8_t save, then_save, load; /* sub-indices, 0: none; the last one is kept */
    const char *image;
    uint32_t communication, manufacturer, application; /* after it is switched off and on */
} images[] = {
    { 1, 0, 0, COMMUNICATION VERIFIED MANUFACTURER APPLICATION, 1111, 2222, 6666 },
    { 2, 0, 0, COMMUNICATION, 1111, 20, 60 },
    { 3, 0, 0, APPLICATION, 0, 20, 6666 },
    { 4, 0, 0, MANUFACTURER, 0, 2222, 60 },
    { 2, 3, 0, COMMUNICATION APPLICATION, 1111, 20, 6666 },
    { 1, 0, 1, "", 0, 20, 60 },
    { 1, 0, 2, MANUFACTURER APPLICATION, 0, 2222, 6666 },
    { 1, 0, 3, COMMUNICATION MANUFACTURER, 1111, 2222, 60 },
    { 1, 0, 4, COMMUNICATION APPLICATION, 1111, 20, 6666 },
    { 0, 0, 1, "", 0, 20, 60 },
    { 0, 0, 3, "", 0, 20, 60 },
};

/* What the image says is what the device has after a reset, and after it was taken back. */
START_TEST(images_of_commands)
{
    const uint8_t saves[] = { images[_i].save, images[_i].then_save };
    struct slave_transfer transfer = { 0, 0 };
    struct slave_store store;
    struct ccf image;

    saver_change_all();
    verify(1, 2);
    ccf_init(&image);
    for (unsigned i = 0; i < 3; i++) {
        if (i < 2 ? saves[i] == 0 : images[_i].load == 0)
            continue;
        transfer = i < 2 ? order(0x1010, saves[i]) : order(0x1011, images[_i].load);
        begin(transfer, &store);
        ccf_done(&image);
        image = store.image;
        ccf_init(&store.image);
        ck_assert_str_ne(finish(transfer, &store), "");
    }
    expect_image(&image, images[_i].image);
    saver_expect("before", 1111, 2222, 6666);
    saver_reset(RESET_NODE);
    saver_expect("after", images[_i].communication, images[_i].manufacturer,
                 images[_i].application);
    slave_done(&saver_device.slave);
    od_done(&saver_device.od);
    device_init(&saver_device, saver_entries);
    ck_assert_int_eq(slave_recall_image(&saver_device.od, &image, &(struct co_report){ 0 }), CO_OK);
    slave_switch_on(&saver_device.slave, 0, &saver_device.out);
    device_drain(&saver_device);
    saver_expect("taken back", images[_i].communication, images[_i].manufacturer,
                 images[_i].application);
    saver_reset(RESET_NODE);
    saver_expect("and reset", images[_i].communication, images[_i].manufacturer,
                 images[_i].application);
    ccf_done(&image);
}
END_TEST

/* A "load" that waits is undone by a later "save" of a part; the rest stays loaded. */
START_TEST(image_of_a_save_after_a_load)
{
    struct slave_transfer transfer;
    struct slave_store store;

    saver_change_all();
    saver_put(0x1010, 1, 4, SAVE);
    saver_put(0x1011, 1, 4, LOAD);
    transfer = order(0x1010, 3);
    begin(transfer, &store);
    expect_image(&store.image, APPLICATION);
    ck_assert_str_eq(finish(transfer, &store), "585#6010100300000000");
    saver_reset(RESET_NODE);
    saver_expect("a part", 0, 20, 6666);
}
END_TEST

/* What changes between the two steps is not in the image, and not the power-on value either. */
START_TEST(changes_meanwhile)
{
    struct slave_transfer transfer;
    struct slave_store store;

    saver_change_all();
    transfer = order(0x1010, 1);
    begin(transfer, &store);
    od_set_number(&saver_device.od, 0x2000, 0, 5);
    finish(transfer, &store);
    ck_assert_uint_eq(device_value(&saver_device, 0x2000, 0), 5);
    saver_reset(RESET_NODE);
    saver_expect("as in the image", 1111, 2222, 6666);
}
END_TEST

START_TEST(reset_meanwhile)
{
    struct slave_transfer transfer;
    struct slave_store store;

    saver_change_all();
    saver_put(0x1010, 1, 4, SAVE);
    saver_put(0x1011, 1, 4, LOAD);
    transfer = order(0x1010, 2);
    begin(transfer, &store);
    saver_reset(RESET_NODE);
    saver_expect("not saved yet", 0, 20, 60);
    ck_assert_str_eq(finish(transfer, &store), ""); /* the client's transfer has ended */
    saver_reset(RESET_NODE);
    saver_expect("saved all the same", 1111, 20, 60);
}
END_TEST

/* What is saved is verified; what was written, or reset, meanwhile is another configuration. */
START_TEST(change_meanwhile_is_not_verified)
{
    struct slave_transfer transfer;
    struct slave_store store;

    saver_change_all();
    verify(1, 2);
    transfer = order(0x1010, 1);
    begin(transfer, &store);
    if (_i == 1)
        saver_put(0x2000, 0, 2, 5);
    if (_i == 2)
        saver_reset(RESET_NODE);
    finish(transfer, &store);
    saver_reset(RESET_COMMUNICATION);
    ck_assert_uint_eq(device_value(&saver_device, 0x1020, 1), _i == 0 ? 1 : 0);
    ck_assert_uint_eq(device_value(&saver_device, 0x1020, 2), _i == 0 ? 2 : 0);
    saver_reset(RESET_NODE);
    saver_expect("as in the image", 1111, 2222, 6666);
    ck_assert_uint_eq(device_value(&saver_device, 0x1020, 1), 1);
}
END_TEST

START_TEST(given_up)
{
    struct slave_transfer transfer;
    struct slave_store store;

    saver_change_all();
    transfer = order(0x1010, 1);
    begin(transfer, &store);
    slave_free_store(&store);
    device_forget(&saver_device);
    slave_verdict(&saver_device.slave, transfer, SDO_HARDWARE, saver_device.now, &saver_device.out);
    device_drain(&saver_device);
    ck_assert_str_eq(device_next_frame(&saver_device, NULL), "585#8010100100000606");
    saver_reset(RESET_NODE);
    saver_expect("nothing saved", 0, 20, 60);
}
END_TEST

START_TEST(the_client_waits)
{
    struct slave_transfer transfer = order(0x1010, 1);
    struct slave_store store;

    device_run(&saver_device, CO_MS(999));
    begin(transfer, &store);
    device_forget(&saver_device);
    device_run(&saver_device, CO_MS(999) + SLAVE_STORE_TIME - 1);
    ck_assert_str_eq(device_next_frame(&saver_device, NULL), "");
    ck_assert_str_eq(finish(transfer, &store), "585#6010100100000000");
    transfer = order(0x1010, 1);
    begin(transfer, &store);
    device_forget(&saver_device);
    device_run(&saver_device, saver_device.now + SLAVE_STORE_TIME);
    ck_assert_str_eq(device_next_frame(&saver_device, NULL), "585#8010100120000008");
    ck_assert_str_eq(device_next_event(&saver_device), "no verdict on 1010:01");
    ck_assert_int_eq(slave_begin_store(&saver_device.slave, transfer, saver_device.now, &store),
                     CO_ERR_STATE);
    slave_free_store(&store);
}
END_TEST

/* ---- taking an image back ---- */

static char told[2000];

static void on_report(void *context, const struct co_message *message)
{
    (void)context;
    strcat(strcat(told, message->text), "\n");
}

static void recall(const char *hex)
{
    struct co_report report = { .file = "f", .sink = on_report };
    uint8_t bytes[200];
    const size_t size = hex_parse(hex, bytes, sizeof bytes);
    struct ccf image;

    told[0] = '\0';
    ck_assert_int_eq(guarded_ccf_parse(bytes, size, &report, &image), CO_OK);
    ck_assert_int_eq(slave_recall_image(&saver_device.od, &image, &report), CO_OK);
    ccf_done(&image);
}

START_TEST(what_does_not_fit)
{
    od_find(&saver_device.od, 0x6000, 0)->has_high = true;
    od_find(&saver_device.od, 0x6000, 0)->high = 100;
    recall("0B000000"
           "05100004000000"
           "80000000" /* its DefaultValue */
           "05100004000000"
           "01010040"               /* SYNC on a CAN-ID that others may not have */
           "0610000400000005000000" /* good */
           "0020000100000007"       /* a byte, two expected */
           "01200041000000"
           "41414141414141414141414141414141"
           "41414141414141414141414141414141"
           "41414141414141414141414141414141"
           "41414141414141414141414141414141"
           "41"
           "0220000200000007"
           "00"               /* clients cannot write it */
           "0320000100000007" /* a domain */
           "00600002000000"
           "6500" /* above its limit */
           "09900001000000"
           "05" /* no such object */
           "03100001000000"
           "05" /* the error history */
           "0610000400000006000000" /* again: the last one counts */);
    ck_assert_str_eq(
        told, "f: warning: 1005h:00 has a CAN-ID that belongs to another service; it gets its "
              "default value\n"
              "f: warning: 2000h:00 has 1 bytes, the device expects 2; it gets its default value\n"
              "f: warning: 2001h:00 has 65 bytes, the device has room for 64; it gets its default "
              "value\n"
              "f: warning: 2002h:00 is stored, but the device has no such parameter; it is left "
              "out\n"
              "f: warning: 2003h:00 is stored, but the device has no such parameter; it is left "
              "out\n"
              "f: warning: 6000h:00 is outside the limits of the device; it gets its default "
              "value\n"
              "f: warning: 9009h:00 is stored, but the device has no such object; it is left out\n"
              "f: warning: 1003h:00 is stored, but the device has no such parameter; it is left "
              "out\n");
    saver_expect("only one", 6, 20, 60);
}
END_TEST

/* One image after the other: the first leaves nothing behind. */
START_TEST(recalled_anew)
{
    od_set_number(&saver_device.od, 0x2000, 0, 77); /* by the application */
    recall("02000000"
           "0610000400000005000000"
           "01200002000000"
           "4142");
    saver_expect("first", 5, 77, 60);
    recall("01000000"
           "00600002000000"
           "0500");
    saver_expect("second", 0, 77, 5);
    ck_assert_uint_eq(od_find(&saver_device.od, 0x2001, 0)->size, 0);
    ck_assert_int_eq(slave_recall_image(&saver_device.od, NULL, NULL), CO_OK);
    saver_expect("none", 0, 77, 60);
    saver_put(0x1011, 1, 4, LOAD);
    saver_reset(RESET_NODE);
    saver_expect("reset", 0, 20, 60);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("slave_image");

    tcase_add_checked_fixture(tcase, saver_setup, saver_teardown);
    tcase_add_loop_test(tcase, images_of_commands, 0, (int)(sizeof images / sizeof images[0]));
    tcase_add_test(tcase, image_of_a_save_after_a_load);
    tcase_add_test(tcase, changes_meanwhile);
    tcase_add_test(tcase, reset_meanwhile);
    tcase_add_loop_test(tcase, change_meanwhile_is_not_verified, 0, 3);
    tcase_add_test(tcase, given_up);
    tcase_add_test(tcase, the_client_waits);
    tcase_add_test(tcase, what_does_not_fit);
    tcase_add_test(tcase, recalled_anew);
    return suite_run("slave_image", tcase);
}
