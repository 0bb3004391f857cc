/* The types of scanopen.h as programs use them, and the second spellings of names. */
#include "scanopen.h"
#include "support/suite.h"

#include <string.h>

/* Each record is its member of the union. */
START_TEST(records_of_the_data_types)
{
    DictionaryData data;
    pDictionaryData all = &data;
    const RecBool *boolean = &all->boolean;
    const RecInt8 *int8 = &all->int8;
    const RecInt16 *int16 = &all->int16;
    const RecInt32 *int32 = &all->int32;
    const RecInt64 *int64 = &all->int64;
    const RecUint8 *uint8 = &all->uint8;
    const RecUint16 *uint16 = &all->uint16;
    const RecUint32 *uint32 = &all->uint32;
    const RecUint64 *uint64 = &all->uint64;
    const RecFloat *float32 = &all->float32;
    const RecDouble *float64 = &all->float64;
    const RecTimeOfDay *day = &all->timeofday;
    const RecTimeDifference *difference = &all->timedifference;

    memset(&data, 0xFF, sizeof data);
    ck_assert_uint_eq(boolean->val, 0xFF);
    ck_assert_int_eq(int8->val, -1);
    ck_assert_int_eq(int16->defval, -1);
    ck_assert_int_eq(int32->minval, -1);
    ck_assert_int_eq(int64->maxval, -1);
    ck_assert_uint_eq(uint8->val, UINT8_MAX);
    ck_assert_uint_eq(uint16->defval, UINT16_MAX);
    ck_assert_uint_eq(uint32->minval, UINT32_MAX);
    ck_assert_uint_eq(uint64->maxval, UINT64_MAX);
    ck_assert_uint_eq(day->val.usDays, UINT16_MAX);
    ck_assert_uint_eq(difference->defval.usDays, UINT16_MAX);
    ck_assert(float32->val != float32->val && float64->val != float64->val); /* no numbers */
}
END_TEST

START_TEST(spellings_of_handles)
{
    HNODE node = NULL;
    HNDO second = node;
    HND0 third = second;

    ck_assert_int_eq(canOpenDeleteNode(third), SCANOPEN_INVALID_HANDLE);
}
END_TEST

START_TEST(spellings_of_members)
{
    SLAVE_NODE_INFO info = { .ucMaxIdentityObject = 1 };

    info.pszDevicename = "name";
    ck_assert_str_eq(info.pszDeviceName, "name");
    info.usProducerHBTime = 1;
    ck_assert_uint_eq(info.usProducerHbTime, 1);
    info.usPdoRxQueusize = 2;
    ck_assert_uint_eq(info.usPdoRxQueueSize, 2);
    info.ucLifetime = 3;
    ck_assert_uint_eq(info.ucLifeTime, 3);
}
END_TEST

START_TEST(spellings_of_values)
{
    ck_assert_uint_eq(THREAD_PRIO_OVERWRITE, THREAD_PRIOS_OVERWRITE);
    ck_assert_uint_eq(PARAM_GET_TIMESTAMP, PARA_GET_TIMESTAMP);
    ck_assert_uint_eq(PARAM_GET_TIMESTAMP_FREQUENCY, PARA_GET_TIMESTAMP_FREQUENCY);
    ck_assert_int_eq(AUTO_NOTIFY, AUTO_NOTIFY_PDO);
    ck_assert_int_eq(PRODUCER_HERTBEAT, PRODUCER_HEARTBEAT);
    ck_assert_uint_eq(DEFAULT_PDO_1, DEFAULT_PDO1);
    ck_assert_uint_eq(DEFAULT_PDO_2, DEFAULT_PDO2);
    ck_assert_uint_eq(DEFAULT_PDO_3, DEFAULT_PDO3);
    ck_assert_uint_eq(DEFAULT_PDO_4, DEFAULT_PDO4);
}
END_TEST

static int on_data(int net, int node, int index, int sub, void *data)
{
    return net + node + index + sub + (data != NULL);
}

static int on_time(int net, int node, int index, int sub, void *data, uint64_t time)
{
    return net + node + index + sub + (data != NULL) + (int)time;
}

static int on_event(SLAVE_EVENT *event)
{
    return (int)event->ulEvent;
}

static int on_old_event(int place, int event, int arg1, int arg2)
{
    return CANOPEN_NET(place) * 1000 + CANOPEN_NODE(place) + event + arg1 + arg2;
}

START_TEST(types_of_handlers)
{
    PFN_COS_DATA_HANDLER data = on_data;
    PFN_COS_DATA_HANDLER_TS time = on_time;
    PFN_COS_EVENT_HANDLER event = on_event;
    PFN_COS_EVENT_HANDLER_OLD old = on_old_event;
    SLAVE_EVENT reset = { .ulEvent = EV_RESET };

    ck_assert_int_eq(data(1, 2, 3, 4, &reset), 11);
    ck_assert_int_eq(time(1, 2, 3, 4, NULL, 5), 15);
    ck_assert_int_eq(event(&reset), 4);
    ck_assert_int_eq(old(0x0205, 1, 1, 1), 2008);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("types");

    tcase_add_test(tcase, records_of_the_data_types);
    tcase_add_test(tcase, spellings_of_handles);
    tcase_add_test(tcase, spellings_of_members);
    tcase_add_test(tcase, spellings_of_values);
    tcase_add_test(tcase, types_of_handlers);
    return suite_run("scan_types", tcase);
}
