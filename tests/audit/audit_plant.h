/*
 * A plant for the tests of mcanopen check: an XML file and a DCF for each node, in a folder of
 * their own, and what the audit tells about them.
 */
#ifndef TEST_AUDIT_PLANT_H
#define TEST_AUDIT_PLANT_H

#include "audit/audit.h"

/* Pieces of DCF files: a value is "DefaultValue=1\n", "ParameterValue=1\n", or both. */
#define VAR(name, type, access, values)                                                            \
    "[" name "]\nParameterName=x\nObjectType=7\nDataType=" type "\nAccessType=" access "\n" values \
    "PDOMapping=0\n"
#define MAPPABLE(name, type, access)                                                               \
    "[" name "]\nParameterName=x\nObjectType=7\nDataType=" type "\nAccessType=" access             \
    "\nDefaultValue=0\nPDOMapping=1\n"
#define OBJECT(name, subs)                                                                         \
    "[" name "]\nParameterName=x\nObjectType=9\nSubNumber=" subs                                   \
    "\n" VAR(name "sub0", "5", "ro", "")
#define U8(name, values)  VAR(name, "5", "rw", values)
#define U16(name, values) VAR(name, "6", "rw", values)
#define U32(name, values) VAR(name, "7", "rw", values)
#define IS(value)         "DefaultValue=" value "\n"
#define SET(value)        "ParameterValue=" value "\n"

struct audit_case {
    const char *network; /* elements of <Manager_Instance> */
    const char *xml5;    /* elements of node 5; NULL: there is none */
    const char *dcf5;    /* objects of its DCF; NULL: it has none */
    const char *xml6;
    const char *dcf6;
    const char *rules; /* that are broken, in order: "identity, no-heartbeat" */
    const char *text;  /* in the messages; NULL: any */
};

/* For checked fixtures: a folder to be in. */
void audit_plant_set_up(void);
void audit_plant_tear_down(void);

void audit_plant_write(const char *name, const char *text);
/* n.xml with these networks. */
void audit_plant_write_case(const struct audit_case *self);

struct audit_told {
    struct co_report report;
    char rules[2000]; /* names, with ", " between; those of the reader of DCF files are left out */
    char text[20000]; /* lines with the names of their rules */
};

void audit_told_init(struct audit_told *self);
/* The audit of n.xml. */
void audit_plant_run(struct audit_told *told);
/* Writes it, runs it, and compares. */
void audit_plant_check(const struct audit_case *self);

#endif
