/*
 * docs/network.xsd, the schema for editors, beside the reader of configuration files: do both take
 * a document?
 *
 * What XML Schema 1.0 cannot say, and the reader refuses all the same, is listed in
 * schema_differences.
 */
#ifndef TEST_SUPPORT_SCHEMA_H
#define TEST_SUPPORT_SCHEMA_H

#include <stdbool.h>
#include <stddef.h>

#define SCHEMA_TEXT_SIZE 20000u

/* What only the reader refuses. */
struct schema_difference {
    const char *message; /* a part of what it says */
    const char *why;
    const char *document; /* one that shows it */
    size_t size;
};

extern const struct schema_difference schema_differences[];
extern const size_t schema_difference_count;

void schema_load(void);
void schema_free(void);

bool schema_takes(const char *text, size_t size);
bool reader_takes(const char *text, size_t size);

/* Fails the test where one takes it and the other does not, but for the differences; true: the
 * schema takes it. */
bool schema_agrees(const char *text);

struct schema_text { /* that grows */
    char bytes[SCHEMA_TEXT_SIZE];
    size_t size;
};

void schema_put(struct schema_text *self, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
