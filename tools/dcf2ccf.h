/*
 * dcf2ccf: what its parts share. Each of them tells the user what is wrong; false means that it
 * was, and that nothing is to be written.
 */
#ifndef TOOLS_DCF2CCF_H
#define TOOLS_DCF2CCF_H

#include "dcf2ccf_files.h"

#include <stdint.h>

struct dcf2ccf_arguments {
    const char *input;   /* "-": stdin; NULL: there is a network instead */
    const char *network; /* the XML file; NULL: one DCF */
    const char *output;  /* "-": stdout; of a network the folder; NULL: beside the input */
    const char *depfile; /* NULL: none */
    uint8_t node_id;     /* 0: that of the file */
    bool old_style, all, quiet;
};

/* dcf2ccf_convert.c: one DCF */
bool dcf2ccf_convert(const struct dcf2ccf_arguments *arguments, struct ccf_files *files);

/* dcf2ccf_network.c: the DCFs of a network */
bool dcf2ccf_convert_network(const struct dcf2ccf_arguments *arguments, struct ccf_files *files);

#endif
