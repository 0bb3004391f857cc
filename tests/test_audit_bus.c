/* mcanopen check: CAN-IDs, SYNC, PDOs, bus load, boot time. */
#include "audit/audit_plant.h"

#include "support/suite.h"

#include <stdio.h>
#include <string.h>

#define ROWS(table) (sizeof(table) / sizeof *(table))

#define ELEMENT(name, n) "<" name ">" n "</" name ">\n"
#define SYNC(us)         ELEMENT("Sync_Interval", us)

/* Communication and mapping parameters of a PDO: "4", "180", "1A0" are those of TPDO 1. */
#define PDO(communication, mapping, n, cob_id, type, more, count, objects)                         \
    OBJECT(communication n, "6")                                                                   \
    U32(communication n "sub1", cob_id)                                                            \
    U8(communication n "sub2", type)                                                               \
    more OBJECT_1(mapping n, count) objects
#define OBJECT_1(name, count)                                                                      \
    "[" name "]\nParameterName=x\nObjectType=9\nSubNumber=3\n" U8(name "sub0", SET(count))
#define TPDO(n, cob_id, type, more, count, objects)                                                \
    PDO("180", "1A0", n, cob_id, type, more, count, objects)
#define RPDO(n, cob_id, type, more, count, objects)                                                \
    PDO("140", "160", n, cob_id, type, more, count, objects)
#define MAPS(name, object) U32(name, SET(object))

/* What can be mapped. */
#define INPUTS  MAPPABLE("6000", "5", "ro") MAPPABLE("6001", "6", "ro") MAPPABLE("6002", "2", "ro")
#define OUTPUTS MAPPABLE("6200", "5", "rww") MAPPABLE("6201", "6", "rww")

/* The usual ends of a link: one byte of node 5 for node 6. */
#define SENDS(cob_id, type) TPDO("0", cob_id, type, "", "1", MAPS("1A00sub1", "0x60000008")) INPUTS
#define HEARS(cob_id, type) RPDO("0", cob_id, type, "", "1", MAPS("1600sub1", "0x62000008")) OUTPUTS
#define EVENT               SET("255")

/* --- CAN-IDs --- */

static const struct audit_case can_ids[] = {
    { .xml5 = "",
      .dcf5 = SENDS(SET("0x185"), EVENT),
      .xml6 = "",
      .dcf6 = HEARS(SET("0x185"), EVENT),
      .rules = "" },
    { .xml5 = "",
      .dcf5 = SENDS(SET("0x185"), EVENT),
      .xml6 = "",
      .dcf6 = SENDS(SET("0x185"), EVENT),
      .rules = "pdo-producers",
      .text = "error: CAN-ID 185h of TPDO 1 (1800h:01) of node 6 is that of TPDO 1 (1800h:01) of "
              "node 5 as well: a PDO has one producer" },
    { .xml5 = "", .dcf5 = SENDS(SET("0x80000185"), EVENT), .xml6 = "", .dcf6 = "", .rules = "" },
    { .xml5 = "",
      .dcf5 = SENDS(SET("0x86"), EVENT),
      .xml6 = "",
      .dcf6 = U32("1014", IS("$NODEID+0x80")),
      .rules = "id-collision",
      .text = "5.dcf:80: error: CAN-ID 086h of TPDO 1 (1800h:01) of node 5 is that of the "
              "emergencies (1014h) of node 6 as well" },
    { .xml5 = "", .dcf5 = SENDS(SET("0x86"), EVENT), .xml6 = "", .dcf6 = "", .rules = "" },
    { .xml5 = "",
      .dcf5 = U32("1014", SET("0x86")),
      .xml6 = "",
      .dcf6 = U32("1014", SET("0x86")),
      .rules = "emcy-id, id-collision" },
    { .xml5 = "", .dcf5 = U32("1014", SET("0x80000086")), .rules = "" },
    { .xml5 = "",
      .dcf5 = U32("1014", IS("0x85")) OBJECT("1028", "2") U32("1028sub1", SET("0x86")),
      .rules = "emcy-producer" },
    { .xml5 = "",
      .dcf5 = OBJECT("1028", "3") U32("1028sub1", SET("0x87")) U32("1028sub2", SET("0x88")),
      .rules = "emcy-producer",
      .text = "node 5 waits for emergencies with CAN-ID 087h (1028h:01) and others, which no" },
    { .xml5 = "",
      .dcf5 = OBJECT("1028", "2") U32("1028sub1", IS("0x86")),
      .rules = "" },                                            /* a default that nobody chose */
    { .xml5 = "", .dcf5 = SENDS(IS("0"), EVENT), .rules = "" }, /* so some files say "none" */
    { .xml5 = "", .dcf5 = SENDS(SET("0"), EVENT), .rules = "restricted-id" },
    { .xml5 = "", .dcf5 = SENDS(SET("0x585"), EVENT), .rules = "restricted-id" },
    { .xml5 = "",
      .dcf5 = SENDS(IS("0x185"), EVENT) U32("1014", IS("0x185")),
      .rules = "emcy-id" }, /* the device's own matter */
    { .xml5 = "",
      .dcf5 = SENDS(SET("0x185"), EVENT) U32("1014", IS("0x185")),
      .rules = "emcy-id, id-collision" },
    { .xml5 = "",
      .dcf5 = OBJECT("1028", "2") U32("1028sub1", SET("0x86")),
      .xml6 = "",
      .dcf6 = U32("1014", IS("0x86")),
      .rules = "" },
    { .xml5 = "",
      .dcf5 = SENDS(SET("0x701"), EVENT),
      .rules = "restricted-id",
      .text = "CAN-ID 701h of TPDO 1 (1800h:01) of node 5 belongs to other services: the device "
              "refuses it (06090030h)" },
    { .xml5 = "", .dcf5 = SENDS(SET("0x706"), EVENT), .rules = "restricted-id" },
    { .xml5 = "", .dcf5 = SENDS(SET("0x680"), EVENT), .rules = "" },
    { .xml5 = "",
      .dcf5 = SENDS(SET("0x20000185"), EVENT),
      .xml6 = "",
      .dcf6 = SENDS(SET("0x185"), EVENT),
      .rules = "" }, /* 29 bits and 11 bits are different frames */
    { .network = SYNC("10000"),
      .xml5 = "",
      .dcf5 = SENDS(SET("0x80"), EVENT),
      .rules = "id-collision",
      .text = "is that of SYNC (1005h) of the manager as well" },
    { .xml5 = "",
      .dcf5 = OBJECT("1201", "3") U32("1201sub1", SET("0x6E1")) U32("1201sub2", SET("0x6E2")),
      .rules = "restricted-id, restricted-id" },
    { .xml5 = "",
      .dcf5 = OBJECT("1201", "3") U32("1201sub1", SET("0x6E1")) U32("1201sub2", SET("0x800006E2")),
      .rules = "" }, /* there is no such channel */
    { .xml5 = "",
      .dcf5 = OBJECT("1280", "4") U32("1280sub1", SET("0x606")) U32("1280sub2", SET("0x586")),
      .xml6 = "",
      .dcf6 = "",
      .rules = "sdo-clients" },
    { .xml5 = "",
      .dcf5 = OBJECT("1280", "4") U32("1280sub1", SET("0x6C0")) U32("1280sub2", SET("0x6C1")),
      .xml6 = "",
      .dcf6 = OBJECT("1201", "3") U32("1201sub1", SET("0x6C0")) U32("1201sub2", SET("0x6C1")),
      .rules = "" },
    { .xml5 = "",
      .dcf5 = OBJECT("1201", "3") U32("1201sub1", SET("0x6C0")) U32("1201sub2", SET("0x6C1")),
      .xml6 = "",
      .dcf6 = OBJECT("1201", "3") U32("1201sub1", SET("0x6C0")) U32("1201sub2", SET("0x6C1")),
      .rules = "id-collision, id-collision" },
};

START_TEST(a_can_id_belongs_to_one)
{
    audit_plant_check(&can_ids[_i]);
}
END_TEST

/* --- SYNC and TIME --- */

#define MAKES_SYNC(cob_id, us) U32("1005", SET(cob_id)) U32("1006", SET(us))

static const struct audit_case syncs[] = {
    { .network = SYNC("10000"), .xml5 = "", .dcf5 = SENDS(SET("0x185"), SET("1")), .rules = "" },
    { .xml5 = "",
      .dcf5 = SENDS(SET("0x185"), SET("1")),
      .rules = "no-sync",
      .text = "5.dcf:87: error: node 5: TPDO 1 has transmission type 1, but nobody sends SYNC" },
    { .network = SYNC("0"), .xml5 = "", .dcf5 = SENDS(SET("0x185"), SET("1")), .rules = "no-sync" },
    { .xml5 = "",
      .dcf5 = SENDS(SET("0x185"), SET("1")),
      .xml6 = "",
      .rules = "unknown-node" }, /* who may send it */
    { .xml5 = "",
      .dcf5 = SENDS(SET("0x185"), SET("1")),
      .xml6 = "",
      .dcf6 = MAKES_SYNC("0x40000080", "10000"),
      .rules = "" },
    { .network = SYNC("10000"),
      .xml5 = "",
      .dcf5 = "",
      .xml6 = "",
      .dcf6 = MAKES_SYNC("0x40000080", "10000"),
      .rules = "sync-producers",
      .text = "error: node 6 sends SYNC, but so does the manager (n.xml:5)" },
    { .xml5 = "",
      .dcf5 = MAKES_SYNC("0x40000080", "10000"),
      .xml6 = "",
      .dcf6 = MAKES_SYNC("0x40000081", "10000"),
      .rules = "sync-producers" },
    { .network = SYNC("10000"), .xml5 = "", .dcf5 = MAKES_SYNC("0x80", "10000"), .rules = "" },
    { .xml5 = "", .dcf5 = MAKES_SYNC("0x40000080", "0"), .rules = "no-sync-period" },
    { .xml5 = "", .dcf5 = MAKES_SYNC("0x80", "0"), .rules = "" },
    { .network = SYNC("10000") ELEMENT("Sync_Cob_Id", "0x81"),
      .xml5 = "",
      .dcf5 = SENDS(SET("0x185"), SET("1")),
      .rules = "sync-id",
      .text =
          "node 5 listens to SYNC with CAN-ID 080h (1005h), but the manager sends it with 081h" },
    { .network = SYNC("10000") ELEMENT("Sync_Cob_Id", "0x90"),
      .xml5 = "",
      .dcf5 = SENDS(SET("0x185"), SET("1")) U32("1005", SET("0x90")),
      .rules = "" },
    { .xml5 = "",
      .dcf5 = U32("1012", SET("0x40000100")),
      .xml6 = "",
      .dcf6 = U32("1012", SET("0x80000100")),
      .rules = "" },
    { .xml5 = "", .dcf5 = U32("1012", SET("0x80000100")), .rules = "no-time" },
    { .xml5 = "",
      .dcf5 = U32("1012", SET("0x40000100")),
      .xml6 = "",
      .dcf6 = U32("1012", SET("0x40000100")),
      .rules = "time-producers" },
};

START_TEST(sync_has_one_producer)
{
    audit_plant_check(&syncs[_i]);
}
END_TEST

/* --- what is mapped --- */

#define SENDS_MAPPED(count, objects)                                                               \
    TPDO("0", SET("0x185"), EVENT, "", count, objects) INPUTS OUTPUTS
#define HEARS_MAPPED(count, objects)                                                               \
    RPDO("0", SET("0x186"), EVENT, "", count, objects) INPUTS OUTPUTS
#define TWO(name, a, b)        MAPS(name "sub1", a) MAPS(name "sub2", b)
#define FOUR(name, a, b, c, d) TWO(name, a, b) MAPS(name "sub3", c) MAPS(name "sub4", d)

static const struct audit_case mappings[] = {
    { .xml5 = "", .dcf5 = SENDS_MAPPED("2", TWO("1A00", "0x60000008", "0x60010010")), .rules = "" },
    { .xml5 = "",
      .dcf5 = SENDS_MAPPED("1", MAPS("1A00sub1", "0x70000008")),
      .rules = "pdo-mapping",
      .text = "node 5: 1A00h:01 maps 7000h:00 with 8 bits into TPDO 1, but the device has no such "
              "entry: boot error J" },
    { .xml5 = "",
      .dcf5 = SENDS_MAPPED("1", MAPS("1A00sub1", "0x60000010")),
      .rules = "pdo-mapping",
      .text = "the entry has fewer" },
    { .xml5 = "",
      .dcf5 = SENDS_MAPPED("1", MAPS("1A00sub1", "0x60010008")),
      .rules = "pdo-part",
      .text = "1A00h:01 maps 6001h:00 with 8 bits into TPDO 1, the entry has more" },
    { .xml5 = "",
      .dcf5 = SENDS_MAPPED("1", MAPS("1A00sub1", "0x10000020")),
      .rules = "pdo-mapping",
      .text = "its PDOMapping is 0" },
    { .xml5 = "",
      .dcf5 = SENDS_MAPPED("1", MAPS("1A00sub1", "0x62000008")),
      .rules = "pdo-mapping",
      .text = "it is for RPDOs only" },
    { .xml5 = "",
      .dcf5 = HEARS_MAPPED("1", MAPS("1600sub1", "0x60000008")),
      .rules = "pdo-mapping, no-producer",
      .text = "it is for TPDOs only" },
    { .xml5 = "",
      .dcf5 = HEARS_MAPPED("2", TWO("1600", "0x00050008", "0x62000008")),
      .rules = "no-producer" },
    { .xml5 = "",
      .dcf5 = HEARS_MAPPED("2", TWO("1600", "0x00060010", "0x62000008")),
      .rules = "pdo-mapping, no-producer",
      .text = "[DummyUsage] does not allow this dummy" },
    { .xml5 = "",
      .dcf5 = SENDS_MAPPED("2", TWO("1A00", "0x00050008", "0x60000008")),
      .rules = "pdo-mapping",
      .text = "a dummy may be in an RPDO only" },
    { .xml5 = "",
      .dcf5 = SENDS_MAPPED("2", TWO("1A00", "0x60030040", "0x60000008"))
          MAPPABLE("6003", "0x1B", "ro"),
      .rules = "pdo-mapping",
      .text = "node 5: 1A00h maps 72 bits into TPDO 1, 64 expected at most" },
    { .xml5 = "",
      .dcf5 = SENDS_MAPPED("1", MAPS("1A00sub1", "0x60030020")) MAPPABLE("6003", "0xF", "ro"),
      .rules = "" },
    { .xml5 = "", .dcf5 = SENDS(SET("0x185"), SET("245")), .rules = "pdo-type" },
    { .xml5 = "", .dcf5 = SENDS(SET("0x185"), SET("254")), .rules = "" },
    { .xml5 = "", .dcf5 = SENDS(SET("0x185"), SET("252")), .rules = "" },
    { .xml5 = "",
      .dcf5 = HEARS(SET("0x185"), SET("253")),
      .rules = "pdo-type, no-producer",
      .text = "type 253 of RPDO 1 is reserved: 0 to 240 and 254 to 255 expected" },
    { .xml5 = "",
      .dcf5 = TPDO("0", IS("0x185"), IS("255"), "", "2", MAPS("1A00sub1", "0x60000008")) INPUTS,
      .rules = "pdo-mapping",
      .text =
          "error: node 5: 1A00h:00 maps 2 objects into TPDO 1, but the device has no 1A00h:02" },
    { .xml5 = "",
      .dcf5 = TPDO("0", IS("0x185"), IS("255"), "", "240", MAPS("1A00sub1", "0x60000008")) INPUTS,
      .rules = "pdo-mapping" },
    { .xml5 = "",
      .dcf5 = TPDO("0", IS("0x185"), IS("255"), "", "255", MAPS("1A00sub1", "0x60000008")) INPUTS,
      .rules = "" }, /* multiplexed */
    { .xml5 = "",
      .dcf5 = TPDO("0", IS("0x185"), IS("255"), "", "0", MAPS("1A00sub1", "0x70000008")),
      .rules = "" }, /* nothing is in it */
};

START_TEST(what_is_mapped_is_there)
{
    audit_plant_check(&mappings[_i]);
}
END_TEST

/* --- links --- */

#define EVERY(ms, n) U16(n "sub5", SET(ms))
#define LINK(dcf5_, dcf6_, rules_)                                                                 \
    .xml5 = "", .dcf5 = dcf5_ INPUTS, .xml6 = "", .dcf6 = dcf6_ OUTPUTS, .rules = rules_
#define FROM(type, more, count, objects) TPDO("0", SET("0x185"), type, more, count, objects)
#define TO(type, more, count, objects)   RPDO("0", SET("0x185"), type, more, count, objects)
#define BYTE_FROM                        MAPS("1A00sub1", "0x60000008")
#define WORD_FROM                        MAPS("1A00sub1", "0x60010010")
#define BYTE_TO                          MAPS("1600sub1", "0x62000008")
#define WORD_TO                          MAPS("1600sub1", "0x62010010")

static const struct audit_case links[] = {
    { LINK(FROM(EVENT, "", "1", BYTE_FROM), TO(EVENT, "", "1", BYTE_TO), "") },
    { LINK(FROM(EVENT, "", "1", BYTE_FROM), TO(EVENT, "", "1", WORD_TO), "pdo-length"),
      .text = "6.dcf:98: error: RPDO 1 of node 6 gets TPDO 1 of node 5 (CAN-ID 185h): 2 bytes "
              "expected, 1 come: it is not processed (emergency 8210h)" },
    { LINK(FROM(EVENT, "", "1", WORD_FROM), TO(EVENT, "", "1", BYTE_TO), "pdo-excess") },
    { LINK(FROM(EVENT, "", "2", TWO("1A00", "0x60000008", "0x60010010")),
           TO(EVENT, "", "2", TWO("1600", "0x62010010", "0x62000008")), "pdo-layout"),
      .text = "at bit 0 it expects 6201h:00 (16 bits, UNSIGNED16), there comes 6000h:00 (8 bits, "
              "UNSIGNED8)" },
    { LINK(FROM(EVENT, "", "1", MAPS("1A00sub1", "0x60020008")), TO(EVENT, "", "1", BYTE_TO),
           "pdo-layout") },
    { LINK(FROM(EVENT, "", "2", TWO("1A00", "0x60020008", "0x60000008")),
           TO(EVENT, "", "2", TWO("1600", "0x00050008", "0x62000008")), "") },
    { LINK(FROM(SET("253"), "", "1", BYTE_FROM), TO(EVENT, "", "1", BYTE_TO), "pdo-request") },
    { LINK(FROM(EVENT, EVERY("100", "1800"), "1", BYTE_FROM),
           TO(EVENT, EVERY("100", "1400"), "1", BYTE_TO), "pdo-deadline"),
      .text = "it waits 100 ms (1400h:05), but that comes each 100.0 ms only: emergency 8250h" },
    { LINK(FROM(EVENT, EVERY("100", "1800"), "1", BYTE_FROM),
           TO(EVENT, EVERY("101", "1400"), "1", BYTE_TO), "") },
    { .network = SYNC("20000"),
      LINK(FROM(SET("5"), "", "1", BYTE_FROM), TO(EVENT, EVERY("100", "1400"), "1", BYTE_TO),
           "pdo-deadline") },
    { .xml5 = "",
      .dcf5 = HEARS(SET("0x186"), EVENT),
      .rules = "no-producer",
      .text = "node 5: RPDO 1 has CAN-ID 186h, which no node sends" },
    { .xml5 = "",
      .dcf5 = HEARS(SET("0x186"), EVENT),
      .xml6 = "",
      .rules = "unknown-node" }, /* which may send it */
    { .xml5 = "",
      .dcf5 = HEARS(IS("$NODEID+0x200"), EVENT),
      .rules = "open-rpdo",
      .text = "n.xml:7: info: node 5: no node sends RPDO 1 (205h): it is the application's to do" },
    { .xml5 = "", .dcf5 = HEARS(SET("0x205"), EVENT), .rules = "open-rpdo" },
};

START_TEST(what_is_sent_is_what_is_awaited)
{
    audit_plant_check(&links[_i]);
}
END_TEST

/* --- estimates --- */

static struct audit_told told;
static struct audit audit;

static struct audit_network *open_plant(const struct audit_case *plant)
{
    audit_told_init(&told);
    audit_plant_write_case(plant);
    audit = (struct audit){ .xml_path = "n.xml", .report = &told.report };
    ck_assert(audit_open(&audit));
    ck_assert(audit_run(&audit));
    return &audit.networks[0];
}

#define BEAT(n) U16("1017", IS("0") SET(n))

/* The longest frames: 55, 65, 135 bits with 0, 1, 8 bytes; 160 bits with 8 bytes and 29 bits. */
START_TEST(frames_are_as_long_as_they_may_be)
{
    ck_assert_uint_eq(audit_frame_bits(false, 0, true), 55);
    ck_assert_uint_eq(audit_frame_bits(false, 1, true), 65);
    ck_assert_uint_eq(audit_frame_bits(false, 8, true), 135);
    ck_assert_uint_eq(audit_frame_bits(true, 0, true), 80);
    ck_assert_uint_eq(audit_frame_bits(true, 8, true), 160);
    ck_assert_uint_eq(audit_frame_bits(false, 8, false), 111);
}
END_TEST

static const struct {
    struct audit_case plant;
    uint64_t cyclic, most; /* bits in a second */
    unsigned unbounded;
} loads[] = {
    { { .xml5 = "", .dcf5 = "", .rules = "" }, 0, 0, 0 },
    { { .xml5 = "", .dcf5 = BEAT("100"), .rules = "" }, 650, 650, 0 },
    { { .network = ELEMENT("Heartbeat_Producer_Time", "100"), .xml5 = "", .dcf5 = "" },
      650,
      650,
      0 },
    { { .xml5 = ELEMENT("Guard_Time", "100") ELEMENT("Life_Time_Factor", "3"), .dcf5 = "" },
      1200,
      1200,
      0 },
    { { .network = SYNC("10000"), .xml5 = "", .dcf5 = "" }, 5500, 5500, 0 },
    { { .xml5 = "", .dcf5 = MAKES_SYNC("0x40000080", "10000") U8("1019", SET("10")) },
      6500,
      6500,
      0 },
    { { .xml5 = "", .dcf5 = MAKES_SYNC("0x60000080", "10000") }, 8000, 8000, 0 },
    { { .network = SYNC("10000"), .xml5 = "", .dcf5 = SENDS(SET("0x185"), SET("2")) },
      5500 + 3250,
      5500 + 3250,
      0 },
    { { .network = SYNC("10000"), .xml5 = "", .dcf5 = SENDS(SET("0x185"), SET("0")) },
      5500,
      5500 + 6500,
      0 },
    { { .xml5 = "", .dcf5 = SENDS(SET("0x185"), EVENT) }, 0, 0, 1 },
    { { .xml5 = "",
        .dcf5 = TPDO("0", SET("0x185"), EVENT, EVERY("100", "1800") U16("1800sub3", SET("100")),
                     "1", BYTE_FROM) INPUTS },
      650,
      6500,
      0 },
    { { .xml5 = "",
        .dcf5 = TPDO("0", SET("0x185"), EVENT, U16("1800sub3", SET("100")), "1", BYTE_FROM)
            INPUTS },
      0,
      6500,
      0 },
    { { .xml5 = "", /* of unknown length */
        .dcf5 = OBJECT("1800", "6") U32("1800sub1", SET("0x185")) U8("1800sub2", EVENT)
            EVERY("100", "1800") },
      1350,
      1350,
      1 },
    { { .xml5 = "",
        .dcf5 = TPDO("0", SET("0x20000185"), EVENT, EVERY("100", "1800"), "1", BYTE_FROM) INPUTS },
      900,
      900,
      1 },
    { { .xml5 = "", .dcf5 = SENDS(SET("0x185"), SET("253")) }, 0, 0, 0 },
};

START_TEST(the_load_is_what_comes_by_itself)
{
    const struct audit_load *load = &open_plant(&loads[_i].plant)->load;

    ck_assert_uint_eq(load->cyclic, loads[_i].cyclic * 1000);
    ck_assert_uint_eq(load->most, loads[_i].most * 1000);
    ck_assert_uint_eq(load->unbounded, loads[_i].unbounded);
    ck_assert_uint_eq(load->unknown, 0);
    audit_close(&audit);
}
END_TEST

/* 500 kbit/s: SYNC each 1 ms is 11 %, a TPDO of 8 bytes with it 27 %. */
#define CYCLIC(n, id) TPDO(n, SET(id), SET("1"), "", "1", MAPS("1A0" n "sub1", "0x60030040"))
#define LONG_INPUT    MAPPABLE("6003", "0x1B", "ro")

static const struct audit_case overloads[] = {
    { .network = SYNC("1000"),
      .xml5 = "",
      .dcf5 = CYCLIC("0", "0x185") CYCLIC("1", "0x285") LONG_INPUT,
      .rules = "" }, /* 65 % */
    { .network = SYNC("1000") ELEMENT("Heartbeat_Producer_Time", "100"),
      .xml5 = "",
      .dcf5 = CYCLIC("0", "0x185") CYCLIC("1", "0x285") LONG_INPUT BEAT("2"),
      .rules = "bus-load",
      .text = "n.xml:4: warning: timers and SYNC take 71 % of the bus at 500 kbit/s" },
    { .network = SYNC("1000"),
      .xml5 = "",
      .dcf5 = CYCLIC("0", "0x185") CYCLIC("1", "0x285") CYCLIC("2", "0x385") CYCLIC("3", "0x485")
          LONG_INPUT,
      .rules = "bus-overload",
      .text = "n.xml:4: error: timers and SYNC ask for 119 % of the bus at 500 kbit/s" },
};

START_TEST(too_much_is_told)
{
    audit_plant_check(&overloads[_i]);
}
END_TEST

#define MANDATORY                                                                                  \
    ELEMENT("NMT_Mandatory_Slave", "TRUE")                                                         \
    ELEMENT("Vendor_Identification", "0x11") ELEMENT("Consumer_Heartbeat_Time", "500")

/* Two reads and one write: 6 frames. With the longest frames 1620 us, and 3 ms for the answers. */
START_TEST(the_boot_is_its_requests)
{
    const struct audit_case plant = { .xml5 = MANDATORY, .dcf5 = BEAT("200") };
    const struct audit_boot *boot = &open_plant(&plant)->boot;

    ck_assert_uint_eq(boot->requests, 3);
    ck_assert_uint_eq(boot->least, 6 * 111 * 2);
    ck_assert_uint_eq(boot->likely, 6 * 135 * 2 + 3000 + 200000);
    ck_assert_uint_eq(boot->likely_mandatory, boot->likely);
    ck_assert_str_eq(told.rules, "");
    audit_close(&audit);
}
END_TEST

#define TEXT_100                                                                                   \
    "0123456789012345678901234567890123456789012345678901234567890123456789012345678901234567890"  \
    "123456789"
#define STRING VAR("2000", "9", "rw", SET(TEXT_100))

static const struct {
    const char *elements;
    unsigned requests;
} texts[] = {
    { "", 1 + 1 + 15 },                              /* 1000h; initiate, segments of 7 bytes */
    { ELEMENT("SDO_Block_Size", "127"), 1 + 2 + 1 }, /* 1000h; initiate and end, one block */
    { ELEMENT("Verify_Configuration", "TRUE"), 1 + 2 * 16 },
    { ELEMENT("Save_Configuration", "TRUE"), 1 + 16 + 1 },
};

START_TEST(long_values_take_more)
{
    const struct audit_case plant = { .xml5 = texts[_i].elements, .dcf5 = STRING };

    ck_assert_uint_eq(open_plant(&plant)->boot.requests, texts[_i].requests);
    audit_close(&audit);
}
END_TEST

static const struct audit_case quiet[] = {
    { .network = ELEMENT("NMT_Master", "FALSE"), .xml5 = "", .dcf5 = BEAT("200") },
    { .xml5 = ELEMENT("NMT_Slave", "FALSE"), .dcf5 = BEAT("200") },
    { .xml5 = ELEMENT("NMT_Auto_Start_Slave", "FALSE"), .dcf5 = BEAT("200") },
};

START_TEST(who_is_not_booted_takes_no_time)
{
    ck_assert_uint_eq(open_plant(&quiet[_i])->boot.requests, 0);
    audit_close(&audit);
}
END_TEST

static const struct audit_case boot_times[] = {
    { .network = ELEMENT("Boot_Time", "1000"), .xml5 = MANDATORY, .dcf5 = BEAT("200") },
    { .network = ELEMENT("Boot_Time", "200"),
      .xml5 = MANDATORY,
      .dcf5 = BEAT("200"),
      .rules = "boot-time-margin",
      .text = "n.xml:5: warning: Boot_Time: 200 ms, but the mandatory nodes are estimated to take "
              "204 ms" },
};

START_TEST(a_boot_has_the_time_it_needs)
{
    struct audit_case plant = boot_times[_i];

    plant.rules = plant.rules ? plant.rules : "";
    audit_plant_check(&plant);
}
END_TEST

/* 100 ms are 450 frames: a domain of some kilobytes. */
START_TEST(no_boot_is_faster_than_the_wire)
{
    const struct audit_case plant = {
        .network = ELEMENT("Boot_Time", "100"),
        .xml5 = MANDATORY,
        .dcf5 = BEAT("200") VAR("2000", "0xF", "rw", "DownloadFile=long.bin\n"),
        .rules = "boot-time",
        .text = "n.xml:5: error: Boot_Time: 100 ms, but the requests to the mandatory nodes take "
    };
    static char bytes[4000];

    memset(bytes, 'x', sizeof bytes - 1);
    audit_plant_write("long.bin", bytes);
    audit_plant_check(&plant);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("audit-bus");

    tcase_add_checked_fixture(tests, audit_plant_set_up, audit_plant_tear_down);
    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, a_can_id_belongs_to_one, 0, ROWS(can_ids));
    tcase_add_loop_test(tests, sync_has_one_producer, 0, ROWS(syncs));
    tcase_add_loop_test(tests, what_is_mapped_is_there, 0, ROWS(mappings));
    tcase_add_loop_test(tests, what_is_sent_is_what_is_awaited, 0, ROWS(links));
    tcase_add_test(tests, frames_are_as_long_as_they_may_be);
    tcase_add_loop_test(tests, the_load_is_what_comes_by_itself, 0, ROWS(loads));
    tcase_add_loop_test(tests, too_much_is_told, 0, ROWS(overloads));
    tcase_add_test(tests, the_boot_is_its_requests);
    tcase_add_loop_test(tests, long_values_take_more, 0, ROWS(texts));
    tcase_add_loop_test(tests, who_is_not_booted_takes_no_time, 0, ROWS(quiet));
    tcase_add_loop_test(tests, a_boot_has_the_time_it_needs, 0, ROWS(boot_times));
    tcase_add_test(tests, no_boot_is_faster_than_the_wire);
    return suite_run("audit-bus", tests);
}
