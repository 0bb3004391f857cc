/*
 * What the manager's file says about the priorities of threads, as the operating system has them.
 *
 *   in   Manager_Thread_Priorities, Slave_Thread_Priorities, Native_Thread_Priorities
 *   out  priorities of SCHED_FIFO; 0: as the system has it
 */
#ifndef CO_API_PRIORITY_H
#define CO_API_PRIORITY_H

#include "manager/network_config.h"

enum { PRIO_NMT, PRIO_SDO, PRIO_PDO, PRIO_EMCY, PRIOS }; /* of the daemons for slaves */

/* The highest of those that are given counts for the protocol thread. */
int priority_of_protocol(const struct network_config *config);
int priority_of_control(const struct network_config *config);
/* False: there is nothing about them in the file. */
bool priority_of_slaves(const struct network_config *config, int native[PRIOS]);

#endif
