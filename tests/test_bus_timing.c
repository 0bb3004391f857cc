/* How long frames are on the wire, to the bit, and who wins against whom. */
#include "port/bus_timing.h"

#include "support/hex.h"
#include "support/suite.h"
#include "support/talk.h"

#include <string.h>

#define UNSTUFFED 13u /* CRC delimiter, ACK and its delimiter, end of frame, intermission */

/*
 * From start of frame to the end of the CRC as it is on the wire: i is a stuff bit 1, o a stuff bit
 * 0. After five equal bits, a stuff bit among them, comes one of the other kind.
 */
static const struct {
    const char *frame;
    const char *wire;
} wires[] = {
    /* 34 zeros, the CRC of zeros is 0: one stuff bit behind each five, six in all */
    { "000#", "00000i00000i00000i00000i00000i00000i0000" },
    /* 0 1110 0000i101 000 00i01 011111o11, a run may go from one field into the next */
    { "705#7F", "011100000i10100000i01011111o11101011101101111" },
    /* the stuff bit begins a run of its own: 00000 i 1111 o */
    { "078#3C3C3C3C3C3C3C3C",
      "00000i1111o0000i00100000i1111o0000i1111o0000i1111o0000i1111o0000i1111o0000i1111o0000i"
      "1111o0000i1111o0000i1100100100001" },
    { "605#4000100000000000",
      "01100000i010100010000100000i00000i00000i00100000i00000i00000i00000i00000i00000i00000i"
      "00000i00000i11010101110110" },
    { "7FF#FFFFFFFFFFFFFFFF",
      "011111o11111o1000100011111o11111o11111o11111o11111o11111o11111o11111o11111o11111o1111"
      "1o11111o11111o00110010001001" },
    /* five equal bits end the CRC: the stuff bit comes nevertheless */
    { "009#", "00000i000100100000i0011111o0000i100000i" },
    { "000#R", "00000i00000i00100000i0111001111000101" },
    { "000#R8", "00000i00000i00100100000i0011111o0000i10" }, /* a length, and no data */
    { "00000000#", "00000i00000i001100000i00000i00000i00000i00000i100011000010000" },
    { "1FFFFFFF#FFFFFFFFFFFFFFFF",
      "011111o11111o11111o11111o11111o11111o1000100011111o11111o11111o11111o11111o11111o1111"
      "1o11111o11111o11111o11111o11111o1111001101101101001" },
    { "00ABCDEF#R1", "00000i010101011111o1001101111011111o0000i01001101010101111" },
};

START_TEST(length_is_that_of_the_bits_on_the_wire)
{
    struct co_frame frame = talk_frame(wires[_i].frame);

    ck_assert_uint_eq(bus_frame_bits(&frame), strlen(wires[_i].wire) + UNSTUFFED);
}
END_TEST

/* What follows from the format alone, stuff bits aside; and the most there can be of those. */
START_TEST(length_is_within_the_bounds_of_the_format)
{
    uint64_t seed = 1;

    for (unsigned i = 0; i < 20000; i++) {
        struct co_frame frame = co_frame_make(noise(&seed) & 0x7FF, (uint8_t)(i % 9));
        unsigned fixed = 47, stuffed = 34, data;

        if (i & 16) {
            frame.flags |= CO_FRAME_EXT;
            frame.id = noise(&seed) & 0x1FFFFFFF;
            fixed = 67;
            stuffed = 54;
        }
        if (i & 32)
            frame.flags |= CO_FRAME_RTR;
        for (unsigned k = 0; k < 8; k++)
            frame.data[k] = i & 64 ? (uint8_t)noise(&seed) : (uint8_t)(noise(&seed) & 1 ? 0 : 255);
        data = frame.flags & CO_FRAME_RTR ? 0 : 8u * frame.dlc;
        ck_assert_uint_ge(bus_frame_bits(&frame), fixed + data);
        ck_assert_uint_le(bus_frame_bits(&frame), fixed + data + (stuffed + data - 1) / 4);
    }
}
END_TEST

/* Each wins against all below it. */
static const char *const ranking[] = {
    "000#",       "000#R", /* a data frame wins against the remote frame of its identifier */
    "00000000#",           /* and base frames against extended ones that begin like them */
    "00000000#R",          /* whose RTR bit comes last */
    "00000001#",  "0003FFFF#", "0003FFFF#R", "001#",      "001#R",     "00040000#",  "080#",
    "7FE#R",      "7FF#",      "7FF#R",      "1FFC0000#", "1FFFFFFF#", "1FFFFFFF#R",
};

START_TEST(priority_is_that_of_arbitration)
{
    for (size_t i = 1; i < sizeof ranking / sizeof ranking[0]; i++) {
        struct co_frame winner = talk_frame(ranking[i - 1]), loser = talk_frame(ranking[i]);

        ck_assert_msg(bus_frame_priority(&winner) < bus_frame_priority(&loser), "%s against %s",
                      ranking[i - 1], ranking[i]);
    }
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("timing");

    tcase_add_loop_test(tests, length_is_that_of_the_bits_on_the_wire, 0,
                        sizeof wires / sizeof wires[0]);
    tcase_add_test(tests, length_is_within_the_bounds_of_the_format);
    tcase_add_test(tests, priority_is_that_of_arbitration);
    return suite_run("bus_timing", tests);
}
