/* The checksum of block transfers, against known values and against the definition. */
#include "base/crc16.h"
#include "support/hex.h"

#include <check.h>
#include <string.h>

static const struct vector {
    const char *bytes;
    size_t count;
    uint16_t crc;
} vectors[] = {
    { "123456789", 9, 0x31C3 }, { "A", 1, 0x58E5 },    { "\xFF", 1, 0x1EF0 },
    { "\x01", 1, 0x1021 },      { "\0\0", 2, 0x0000 }, { "CANopenDemoPIC32", 16, 0x43F3 },
    { "", 0, 0x0000 },
};

START_TEST(test_known_values)
{
    const struct vector *vector = &vectors[_i];

    ck_assert_uint_eq(crc16_add(0, (const uint8_t *)vector->bytes, vector->count), vector->crc);
}
END_TEST

static uint16_t by_definition(const uint8_t *bytes, size_t count)
{
    unsigned crc = 0;

    for (size_t i = 0; i < 8 * count; i++) {
        const unsigned byte = bytes[i / 8], bit = byte >> (7 - i % 8) & 1;

        crc = (crc << 1 & 0xFFFF) ^ ((crc >> 15) != bit ? 0x1021u : 0u);
    }
    return (uint16_t)crc;
}

/* All values of a byte, whole and in parts. */
START_TEST(test_parts)
{
    uint8_t bytes[1024];
    uint64_t seed = 1;

    for (unsigned i = 0; i < sizeof bytes; i++)
        bytes[i] = i < 256 ? (uint8_t)i : (uint8_t)noise(&seed);
    for (size_t count = 0; count <= sizeof bytes; count += 31) {
        const size_t part = count / 3;
        const uint16_t crc = crc16_add(crc16_add(0, bytes, part), bytes + part, count - part);

        ck_assert_uint_eq(crc, by_definition(bytes, count));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("crc16");
    TCase *tcase = tcase_create("crc16");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_known_values, 0, (int)(sizeof vectors / sizeof vectors[0]));
    tcase_add_test(tcase, test_parts);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
