/*
 * ccfread on any bytes: table, JSON, with names and types, and two files against each other.
 *
 * The first byte says what is done; where two files are compared, the second one says where the
 * first of them ends.
 */
#include "ccfread_diff.h"
#include "ccfread_show.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define NAME_SIZE 32u

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char eds_text[] = "[1017]\nParameterName=Heartbeat\nDataType=6\nAccessType=rw\n"
                               "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=1\n"
                               "[1018sub1]\nParameterName=Vendor\nDataType=7\nAccessType=ro\n"
                               "[2000]\nParameterName=Text\nDataType=9\nAccessType=rw\n"
                               "[2001]\nParameterName=Unicode\nDataType=11\nAccessType=rw\n"
                               "[2002]\nParameterName=Real\nDataType=8\nAccessType=rw\n"
                               "[2003]\nParameterName=Time\nDataType=12\nAccessType=rw\n"
                               "[2004]\nParameterName=Domain\nDataType=15\nAccessType=rw\n"
                               "[2005]\nParameterName=Long\nDataType=21\nAccessType=rw\n";

static struct dcf eds;

static void check(bool condition)
{
    if (!condition)
        abort();
}

/* What the tool prints goes nowhere; libFuzzer has a stream of its own. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    struct co_report report = { .file = "eds" };

    (void)argc;
    (void)argv;
    check(dcf_parse(eds_text, sizeof eds_text - 1, &report, &eds) == CO_OK);
    stdout = fopen("/dev/null", "w");
    stderr = fopen("/dev/null", "w");
    check(stdout && stderr);
    return 0;
}

/* A file with these bytes; its name is good until it is closed. */
static int make_file(const uint8_t *data, size_t size, char name[NAME_SIZE])
{
    const int file = memfd_create("fuzz", MFD_CLOEXEC);

    check(file >= 0 && write(file, data, size) == (ssize_t)size);
    snprintf(name, NAME_SIZE, "/dev/fd/%d", file);
    return file;
}

static bool is_whole(const uint8_t *data, size_t size)
{
    struct co_report report = { .file = "fuzz" };
    struct ccf ccf;
    const bool whole = ccf_parse(data, size, &report, &ccf) == CO_OK;

    if (whole)
        ccf_done(&ccf);
    return whole;
}

static void show(unsigned kind, const uint8_t *data, size_t size)
{
    struct show self = { .view = kind & 1 ? &view_json : &view_table,
                         .eds = kind & 2 ? &eds : NULL,
                         .eds_name = "eds" };
    char name[NAME_SIZE];
    const int file = make_file(data, size, name);

    check(self.view->begin());
    check(show_file(&self, name) == (is_whole(data, size) ? EXIT_GOOD : EXIT_FOUND));
    check(self.view->end());
    close(file);
}

static void compare(unsigned kind, const uint8_t *data, size_t size)
{
    const size_t cut = size > 0 ? data[0] % size : 0;
    const struct dcf *names = kind & 2 ? &eds : NULL;
    char a[NAME_SIZE], b[NAME_SIZE];
    const int first = make_file(data, cut, a), second = make_file(data + cut, size - cut, b);
    const int code = diff_files(a, b, names, kind & 1);

    check(code == EXIT_GOOD || code == EXIT_FOUND || code == EXIT_TROUBLE);
    if (is_whole(data + cut, size - cut))
        check(diff_files(b, b, names, kind & 1) == EXIT_GOOD);
    close(first);
    close(second);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return 0;
    if (data[0] & 4)
        compare(data[0], data + 1, size - 1);
    else
        show(data[0], data + 1, size - 1);
    return 0;
}
