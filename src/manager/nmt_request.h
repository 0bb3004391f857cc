/*
 * 1F82h "request NMT" and 1F83h "request guarding" of the manager's dictionary: through them other
 * tools of the network see the states of its nodes and have them commanded (CiA 302-2).
 *
 *   in   SDO requests to the manager, before its device gets them; SLAVE_VERDICT of its device
 *   out  the values to read; commands, as of the application, and the answers; MANAGER_NMT_REQUEST
 *
 * Parts of the manager, on its struct; nobody else calls them.
 */
#ifndef CO_MANAGER_NMT_REQUEST_H
#define CO_MANAGER_NMT_REQUEST_H

#include "manager/manager.h"

/* An SDO request to the manager's device: what it may want to read is brought up to date. */
void nmt_request_refresh(struct manager *self, const struct co_frame *request);
/* A client has written 1F82h: its answer says whether the command was accepted. */
void nmt_request_on_write(struct manager *self, const struct co_event *event, co_us_t now);

#endif
