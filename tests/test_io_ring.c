/* io_uring, the real one of this kernel; and kernels that have none, or an old one. */
#include "port/io_ring.h"

#include "support/suite.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#define ENTRIES 8u
#define SKIPPED 77

static struct io_ring ring;

static void set_up(void)
{
    ck_assert_int_eq(io_ring_open(&ring, ENTRIES, io_ring_setup), CO_OK);
}

static void tear_down(void)
{
    io_ring_close(&ring);
}

static void expect_result(uint64_t number, int result)
{
    uint64_t got_number = 0;
    int got_result = 0;

    ck_assert(io_ring_take(&ring, &got_number, &got_result));
    ck_assert_uint_eq(got_number, number);
    ck_assert_int_eq(got_result, result);
}

static void expect_no_result(void)
{
    uint64_t number;
    int result;

    ck_assert(!io_ring_take(&ring, &number, &result));
}

START_TEST(requests_have_results)
{
    for (uint64_t round = 0; round < 10 * ENTRIES; round++) { /* around both queues */
        for (unsigned i = 0; i < 3; i++)
            io_ring_prepare(&ring, IORING_OP_NOP, 100 * round + i);
        expect_no_result();
        ck_assert_int_eq(io_ring_enter(&ring, 3), CO_OK);
        for (unsigned i = 0; i < 3; i++)
            expect_result(100 * round + i, 0);
        expect_no_result();
    }
}
END_TEST

START_TEST(a_request_that_waits)
{
    int fd = eventfd(0, EFD_NONBLOCK);
    const uint64_t one = 1;
    struct io_uring_sqe *request = io_ring_prepare(&ring, IORING_OP_POLL_ADD, 5);

    request->fd = fd;
    request->poll_events = POLLIN;
    ck_assert_int_eq(io_ring_enter(&ring, 0), CO_OK);
    expect_no_result();
    ck_assert_int_eq(write(fd, &one, sizeof one), sizeof one);
    ck_assert_int_eq(io_ring_enter(&ring, 0), CO_OK); /* it does not wait, but brings it */
    expect_result(5, POLLIN);
    close(fd);
}
END_TEST

START_TEST(a_request_that_fails)
{
    struct io_uring_sqe *request = io_ring_prepare(&ring, IORING_OP_POLL_ADD, 6);

    request->fd = -1;
    request->poll_events = POLLIN;
    ck_assert_int_eq(io_ring_enter(&ring, 1), CO_OK);
    expect_result(6, -EBADF);
}
END_TEST

START_TEST(a_ring_that_is_gone)
{
    close(ring.fd);
    io_ring_prepare(&ring, IORING_OP_NOP, 1);
    ck_assert_int_eq(io_ring_enter(&ring, 1), CO_ERR_IO);
    ring.fd = -1;
}
END_TEST

/* --- other kernels --- */

static int setup_error;
static unsigned setups;

static int fail_setup(unsigned entries, struct io_uring_params *params)
{
    (void)entries;
    (void)params;
    setups++;
    errno = setup_error;
    return -1;
}

static const int setup_errors[] = { ENOSYS, EPERM, EMFILE, ENOMEM, EINVAL };

START_TEST(kernels_without_it)
{
    struct io_ring other;

    setup_error = setup_errors[_i];
    setups = 0;
    ck_assert_int_eq(io_ring_open(&other, ENTRIES, fail_setup), CO_ERR_UNSUPPORTED);
    ck_assert_uint_eq(setups, setup_error == EINVAL ? 2 : 1);
    io_ring_close(&other);
    io_ring_close(&other);
}
END_TEST

static int setup_of_5_18(unsigned entries, struct io_uring_params *params)
{
    if (params->flags != 0) {
        errno = EINVAL;
        return -1;
    }
    return io_ring_setup(entries, params);
}

START_TEST(flags_the_kernel_does_not_know)
{
    io_ring_close(&ring);
    ck_assert_int_eq(io_ring_open(&ring, ENTRIES, setup_of_5_18), CO_OK);
    io_ring_prepare(&ring, IORING_OP_NOP, 7);
    ck_assert_int_eq(io_ring_enter(&ring, 1), CO_OK);
    expect_result(7, 0);
}
END_TEST

static int setup_of_5_6(unsigned entries, struct io_uring_params *params)
{
    int fd = io_ring_setup(entries, params);

    params->features &= ~IORING_FEAT_FAST_POLL;
    return fd;
}

/* A descriptor, but none that can be mapped. */
static int setup_of_a_pipe(unsigned entries, struct io_uring_params *params)
{
    int ends[2];

    (void)entries;
    params->features = ~0u;
    ck_assert_int_eq(pipe(ends), 0);
    close(ends[1]);
    return ends[0];
}

START_TEST(kernels_that_are_too_old)
{
    io_ring_setup_fn *const setup[] = { setup_of_5_6, setup_of_a_pipe };
    struct io_ring other;

    ck_assert_int_eq(io_ring_open(&other, ENTRIES, setup[_i]), CO_ERR_UNSUPPORTED);
    io_ring_close(&other);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("this kernel");

    if (io_ring_open(&ring, ENTRIES, io_ring_setup) != CO_OK) {
        printf("not run: this kernel has no io_uring for us\n");
        return SKIPPED;
    }
    io_ring_close(&ring);
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, requests_have_results);
    tcase_add_test(tests, a_request_that_waits);
    tcase_add_test(tests, a_request_that_fails);
    tcase_add_test(tests, a_ring_that_is_gone);
    tcase_add_loop_test(tests, kernels_without_it, 0, 5);
    tcase_add_test(tests, flags_the_kernel_does_not_know);
    tcase_add_loop_test(tests, kernels_that_are_too_old, 0, 2);
    return suite_run("io_ring", tests);
}
