/*
 * What calls for SDO transfers have in common, whether they wait for the end or not: which
 * arguments are good, and the transfer that they ask for.
 */
#ifndef CO_API_SDO_CALL_H
#define CO_API_SDO_CALL_H

#include "api/registry.h"

struct sdo_call {
    int net, node, index, sub;
    bool block;
};

/* subindex: of the application's call, with or without TYP_BLOCK. */
struct sdo_call sdo_call_read(int net, int node, int index, int subindex);
/* MCANOPEN_OK, MCAL_PARA_ERROR; the net is not looked at. */
int sdo_call_check(const struct sdo_call *call);
/* Of mcanOpenWriteSDO; a *len of 0 becomes the type's. MCANOPEN_OK, MCAL_PARA_ERROR */
int sdo_call_check_type(int type, const void *buffer, int *len);

/*
 * Object, blocks and time-out, as the configuration of the node has them. Under the network's lock:
 * other tools may change the configuration.
 */
void sdo_call_fill(const struct managed *managed, const struct sdo_call *call,
                   struct sdo_transfer *transfer);
/* What a write sends, and how. */
void sdo_call_fill_write(int type, const void *data, int len, struct sdo_transfer *transfer);

#endif
