/*
 * EDS and DCF files (CiA 306): text in, a device description out.
 *
 *   in   the bytes of the file (callers read files), a report for messages with line numbers
 *   out  struct dcf: file and device information, objects with types, access, limits and values
 *
 * What real files do and the standard forbids is accepted with a warning where its meaning is
 * clear.
 * Formulas ($NODEID+200h) are kept as an offset: dcf_value() resolves them for a node-ID.
 */
#ifndef CO_DCF_DCF_H
#define CO_DCF_DCF_H

#include "base/error.h"
#include "base/pool.h"
#include "base/report.h"
#include "dcf/ccf.h"
#include "od/od.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Kinds for co_report_kind(); api/ maps them to CANOPEN_DCF_... */
enum dcf_error {
    DCF_ERROR_NONE,
    DCF_ERROR_MEMORY,
    DCF_ERROR_MISSING_SECTION,
    DCF_ERROR_MISSING_ENTRY,
    DCF_ERROR_WRONG_PARAMETER,
    DCF_ERROR_OUT_OF_RANGE,
    DCF_ERROR_OUT_OF_LIMITS,
    DCF_ERROR_DOUBLE_SECTION,
    DCF_ERROR_DOUBLE_KEYWORD,
    DCF_ERROR_UNKNOWN_KEYWORD,
    DCF_ERROR_WRONG_NODE_ID,
    DCF_ERROR_WRONG_BAUDRATE,
    DCF_ERROR_WRONG_MODULE_NO
};

struct dcf_value { /* as in the file */
    bool given;
    bool has_node_id; /* "$NODEID" is to be added */
    unsigned line;
    uint32_t size;  /* bytes; of numbers the type's size */
    uint8_t *bytes; /* little endian; without the node-ID */
};

struct dcf_entry {
    uint16_t index;
    uint8_t sub;
    uint8_t object_type; /* 2 DOMAIN, 7 VAR, 8 ARRAY, 9 RECORD, ...: of the whole object in sub 0 */
    uint8_t type;        /* enum od_type */
    uint8_t access;      /* enum od_access */
    bool mappable;
    uint32_t flags; /* ObjFlags: bit 0 refuse write on download, bit 1 refuse read on scan */
    unsigned line;  /* of its section */
    char *name;
    char *denotation;
    char *download_file; /* DOMAIN, or NULL */
    char *upload_file;
    struct dcf_value initial;   /* DefaultValue */
    struct dcf_value parameter; /* ParameterValue */
    struct dcf_value low;
    struct dcf_value high;
};

struct dcf {
    struct dcf_entry *entries; /* sorted by index and sub-index */
    size_t count, room;
    struct co_pool pool; /* of all texts and values */
    /* [DeviceInfo] */
    char *vendor_name;
    char *product_name;
    bool has_device_info;
    uint32_t vendor_number, product_number, revision_number;
    unsigned vendor_number_line, product_number_line, revision_number_line; /* 0: not given */
    uint16_t bit_rates; /* bit i: 10, 20, 50, 125, 250, 500, 800, 1000 kbit/s */
    uint8_t granularity;
    unsigned granularity_line; /* 0: not given */
    bool group_messaging;
    uint8_t dummy_usage; /* bit i: dummy 000ih may be mapped */
    uint16_t rx_pdos, tx_pdos;
    /* [DeviceComissioning]; is_dcf tells whether it is there */
    bool is_dcf;
    bool has_node_id;
    uint8_t node_id;
    unsigned node_id_line; /* of NodeID, or of the section */
    char *node_name;
    unsigned baudrate; /* kbit/s; 0: not given */
    unsigned baudrate_line;
    bool is_manager; /* CANopenManager */
    unsigned is_manager_line;
    /* [FileInfo], or NULL */
    char *file_name;
    unsigned file_name_line;
    char *last_eds;
    unsigned last_eds_line;
    char *modification_date;
    char *modification_time;
};

/*
 * Reads a whole file. Errors go to the report, all of them; on one or more the result is
 * CO_ERR_FORMAT and *ret_dcf is empty. CO_ERR_MEMORY.
 */
enum co_err dcf_parse(const char *text, size_t size, struct co_report *report, struct dcf *ret_dcf);
void dcf_done(struct dcf *self);

const struct dcf_entry *dcf_find(const struct dcf *self, uint16_t index, uint8_t sub);

/* The bytes of a value for this node-ID, to 'bytes' of at least value->size; their number. */
uint32_t dcf_value(const struct dcf_value *value, uint8_t node_id, uint8_t *bytes);

/*
 * Fills an empty dictionary with all entries and their DefaultValues; those without one are 0 or
 * empty, but a sub-index 0 tells the highest sub-index. There is room for strings of 64 bytes and,
 * in the first 64 of them, domains of 64 KiB. CO_ERR_MEMORY, CO_ERR_VALUE
 */
enum co_err dcf_make_od(const struct dcf *self, uint8_t node_id, struct co_report *report,
                        struct od *od);

struct dcf_ccf_options {
    uint8_t node_id;
    bool old_style; /* PDO mapping: the number of entries first (Old_Config_Style) */
    bool all;       /* entries without a ParameterValue as well, with their DefaultValue */
    /* The contents of a DownloadFile named in the DCF, to be freed by free(). NULL: such an
     * entry is an error. */
    enum co_err (*read_file)(void *context, const char *name, uint8_t **ret_bytes,
                             size_t *ret_size);
    void *context;
};

/*
 * The writes that bring a device with default values to the ParameterValues of the file, in the
 * order that devices need: the other objects by index; SYNC (1019h, 1006h, 1005h); error control
 * (100Ch, 100Dh, 1016h, 1017h); each PDO switched off, its parameters, its mapping, switched on;
 * 1020h last. Left out are read-only entries, those that ObjFlags protects, 1000h, 1001h, 1010h,
 * 1011h, 1018h, 1200h, 1F50h, 1F51h, and DefaultValues outside their limits. The result has its
 * count even where it is 0.
 * CO_ERR_MEMORY, CO_ERR_VALUE (told in the report).
 */
enum co_err dcf_make_ccf(const struct dcf *self, const struct dcf_ccf_options *options,
                         struct co_report *report, struct ccf *ret_ccf);

#endif
