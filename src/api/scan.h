/*
 * What the files scan_*.c share: the local slaves of this process as the application knows them.
 *
 *   scan.c             this state, and the handles that name parts of it
 *   scan_network.c     canOpenCreateNetwork..., daemons, priorities
 *   scan_node.c        canOpenCreateNode..., a node's life
 *   scan_objects.c     its communication objects
 *   scan_dictionary.c  canOpenExtendDictionary ...
 *   scan_value.c       values as C has them, and as they travel
 *   scan_access.c      reading and writing it
 *   scan_pdo.c         PDOs
 *   scan_pdo_io.c      their data sent, received and requested by the application
 *   scan_file.c        nodes from EDS and DCF files
 *   scan_parameter.c   versions and parameters
 *   scan_time.c        TIME
 *   scan_store.c       the store daemon: power-on values in a file
 *   scan_handlers.c    the PDO daemon: object handlers
 *   scan_sdo.c         the SDO daemon: handlers and files for clients
 *   scan_domain.c      domains in files
 *   scan_events.c      the NMT daemon: node events
 *   scan_error.c       errors of the application; the EMCY daemon: those of others
 *
 *   locking  A call enters its node, which then stays until the call leaves; deleting a node waits
 *            for that. What changes while a node is on the bus changes under its network's lock,
 *            which scan_lock() takes.
 */
#ifndef CO_API_SCAN_H
#define CO_API_SCAN_H

#include "api/priority.h"
#include "runtime/daemon.h"
#include "runtime/network.h"
#include "scanopen.h"

#include <pthread.h>

#define SCAN_NODES    255u /* of the process */
#define SCAN_NETWORKS 256u /* numbers of networks */
#define SCAN_PDOS     512u /* per direction and node */

struct scan_net {
    int number;
    struct network *network;
    unsigned long options; /* of SLAVE_NET_INFO */
    unsigned debug_mask;   /* likewise */
    unsigned nodes;        /* under the change lock of scan.c */
    uint8_t bus_state;     /* as told last; under the network's lock */
    struct daemon nmt, pdo, sdo, emcy;
    bool has_priorities; /* of its own; under the change lock of scan.c */
    struct daemon store; /* started when a node wants it ... */
    bool stores;         /* ... under the change lock of scan.c */
};

/* Where the bytes of a domain are. */
struct scan_domain {
    uint32_t max; /* bytes */
    char path[];
};

/* What the application gave for an entry: od_entry.owner. */
struct scan_entry {
    bool initialized;
    PFN_COS_DATA_HANDLER handler; /* one of these, or none */
    PFN_COS_DATA_HANDLER_TS handler_ts;
    CAN_TIME_OF_DAY time;       /* what canOpenReadDictionary gave a pointer to */
    struct scan_domain *domain; /* NULL: the bytes are in memory */
};

struct scan_pdo {
    uint16_t mode; /* TransMode */
    uint16_t tx_timeout, rx_timeout;
    bool requests;        /* RPDO: RTR_ALLOW */
    uint32_t ask;         /* TPDO: its handlers are wanted, number; 0: not */
    unsigned confirmed;   /* TPDO: of tpdo.sent, how many were on the bus, or given up */
    co_us_t confirmed_at; /* the last one of them */
    unsigned takers;      /* RPDO: calls that wait for its data themselves ... */
    unsigned callers;     /* ... and those that want the handlers to be called */
};

/* A received PDO on its way to the handlers. */
struct scan_received {
    uint16_t number;
    uint8_t dlc;
    uint8_t data[8];
    uint32_t generation; /* of its mapping */
    co_us_t time;
};

struct scan_question { /* of an SDO client, for the SDO daemon */
    bool pending;
    bool reads; /* or writes */
    uint16_t index;
    uint8_t sub;
    uint32_t size; /* of what it writes */
    struct slave_transfer transfer;
    co_us_t time;
};

struct scan_node {
    unsigned slot;
    uint32_t generation;
    unsigned users; /* calls inside; under the lock of scan.c */
    bool closing;
    struct scan_net *net;
    uint8_t id;
    bool active;          /* on the bus: slave is there */
    unsigned activations; /* who waits for something of one has nothing to expect of the next */
    bool from_file;
    bool held; /* PARAM_DISABLE_AUTO_TRANSMISSION */
    unsigned long options, event_mask;
    unsigned char map_max;
    PFN_COS_EVENT_HANDLER on_event;
    PFN_COS_EVENT_HANDLER_OLD on_event_old;
    int last_error;
    bool resetting; /* EV_END is to come */
    unsigned long reset_kind;
    struct od od;
    struct slave slave;
    struct od_entry **handles; /* entries that have a number: od_entry.handle - 1 */
    uint32_t handle_count, handle_room;
    uint16_t rpdo_max, tpdo_max, rpdo_count, tpdo_count;
    struct scan_pdo *rpdos, *tpdos;
    char *store_file; /* NULL: none; changes only off the bus */
    bool storing;     /* the store daemon writes it: the node stays on the bus */
    /* the PDO daemon's part */
    struct scan_received *received; /* a ring */
    unsigned received_size, received_first, received_count, received_lost;
    unsigned asks;   /* TPDOs with ask != 0 */
    bool pdo_called; /* the daemon knows of it */
    /* the SDO daemon's */
    struct scan_question *questions; /* by channel; of this activation or the last one */
    unsigned question_count;
    unsigned question_next; /* channels have their turns */
    bool sdo_called;        /* the daemon knows of it */
};

/* What the daemons get. */
struct scan_token {
    unsigned slot;
    uint32_t generation;
};

/*
 * For the NMT daemon: an event of a node, with what its pArg2 is to point to in 'news', or, without
 * a node, something to be logged.
 */
struct scan_event_token {
    struct scan_token node; /* generation 0: none */
    SLAVE_EVENT event;
    struct co_event news;
};

/* For the EMCY daemon. */
struct scan_emcy_token {
    struct scan_token node;
    SLAVE_EVENT event;
    SLAVE_EMCY emcy;
};

/* For the store daemon: a client's "save" or "load". */
struct scan_store_token {
    struct scan_token node;
    struct slave_transfer transfer;
    unsigned activation;
};

/* ---- scan.c ---- */

/* SCANOPEN_TOO_MANY_OBJECTS, SCANOPEN_OUT_OF_MEMORY. Nobody can enter it until it is opened. */
int scan_new_node(struct scan_node **ret_node);
void scan_open_node(struct scan_node *node);
/* Nobody else may use it. */
void scan_free_node(struct scan_node *node);
/* No call enters any more; waits until all have left. False: somebody else closes it already. */
bool scan_close_node(struct scan_node *node, void (*wake)(struct scan_node *node));

HNODE scan_node_handle(const struct scan_node *node);
HPDO scan_pdo_handle(const struct scan_node *node, bool transmit, uint16_t number);
/* SCANOPEN_OUT_OF_MEMORY */
int scan_entry_handle(struct scan_node *node, struct od_entry *entry, HDICT *ret_handle);
/* An od_entry.owner. */
void scan_free_entry(void *owner);

/* SCANOPEN_INVALID_HANDLE, or the node, and scan_leave() must follow. */
int scan_enter(HNODE handle, struct scan_node **ret_node);
int scan_enter_token(const struct scan_token *token, struct scan_node **ret_node);
int scan_enter_pdo(HPDO handle, struct scan_node **ret_node, bool *ret_transmit,
                   uint16_t *ret_number);
int scan_enter_entry(HDICT handle, struct scan_node **ret_node, uint32_t *ret_number);
void scan_leave(struct scan_node *node);
struct scan_token scan_token(const struct scan_node *node);

/* The network's lock, and the outbox; scan_unlock() sends what was put there. */
struct co_outbox *scan_lock(struct scan_node *node, co_us_t *ret_now);
/* The same, with the time of the last step, where mostly none is needed: see network_clock(). */
struct co_outbox *scan_lock_untimed(struct scan_node *node, co_us_t *ret_now);
void scan_unlock(struct scan_node *node);

/* Under the network's lock: for each node of the network that calls can enter. */
void scan_each_node(const struct scan_net *net,
                    void (*visit)(struct scan_node *node, const void *context),
                    const void *context);

/* NULL: not created. Stays as long as no call removes the network, which needs the change lock. */
struct scan_net *scan_net(int number);
void scan_set_net(int number, struct scan_net *net);
/* Calls that make or delete come one at a time; their messages are told at the end. */
void scan_begin_change(void);
void scan_end_change(void);

/* ---- scan_network.c ---- */

/* Those of the manager's file for the daemons of a network that has none. CO_ERR_PERMISSION */
enum co_err scan_adopt_priorities(int number, const int native[PRIOS]);

/* ---- scan_objects.c ---- */

struct scan_profile { /* the communication objects of a node */
    const SLAVE_NODE_INFO *info;
    bool old; /* of canOpenCreateNode */
    uint8_t id;
};
/* SCANOPEN_WRONG_PARAMETER, SCANOPEN_OUT_OF_MEMORY; od is to be freed in any case. */
int scan_make_objects(const struct scan_profile *profile, struct od *od);

/* ---- scan_value.c ---- */

/* A value as C has it, as far as it is no string. */
union scan_number {
    uint8_t bytes[8];
    uint8_t u8;
    uint16_t u16;
    uint32_t u32;
    uint64_t u64;
    CAN_TIME_OF_DAY time;
};

bool scan_is_text(uint8_t type); /* a string or domain */
/* Bytes of the type in C's form: 4 for those of 3 bytes, 8 for 5 to 7; 0 for the others. */
size_t scan_size(uint8_t type);
/* From little-endian bytes, and back: so many as the type has. */
void scan_number_from(uint8_t type, const uint8_t *bytes, union scan_number *ret_number);
void scan_number_to(uint8_t type, const void *number, uint8_t ret_bytes[8]);
/* What the return value of a handler is to the SDO client. */
sdo_abort_t scan_code_of(int result);
/* The error of the slave interface for a value that the dictionary refuses. */
int scan_error_of_value(sdo_abort_t code);
/* For an object handler: size bytes as they travel. */
union scan_data {
    union scan_number number;
    RecOctString text;
};
void scan_data_from(uint8_t type, uint8_t *bytes, uint32_t size, union scan_data *ret_data);

/* A NUL behind a string that clients may write, where there is room. */
void scan_end_text(const struct od_entry *entry);
/* A mapped object's value in the data of a PDO, in the size of its type. */
void scan_field_bytes(const struct pdo_field *field, const uint8_t data[8], uint8_t ret_bytes[8]);
/* May it be so? With 'store' it becomes so. */
sdo_abort_t scan_take_field(const struct pdo_field *field, const uint8_t data[8], bool store);

/* ---- scan_node.c ---- */

struct scan_order { /* a node to be made */
    int net, id;
    const SLAVE_NODE_INFO *info;
    const char *file; /* EDS or DCF; NULL: as info says */
    bool old;         /* by canOpenCreateNode */
    PFN_COS_EVENT_HANDLER on_event;
    PFN_COS_EVENT_HANDLER_OLD on_event_old;
};
int scan_create_node(const struct scan_order *order, HNODE *ret_handle);

int scan_node_state(const struct scan_node *node);

/* ---- scan_pdo.c ---- */

/* The handles' PDO; NULL: there is none. */
struct scan_pdo *scan_pdo(const struct scan_node *node, bool transmit, uint16_t number);
/* After slave_init(): what the dictionary does not say of the PDOs. Under the lock. */
void scan_set_pdo_flags(struct scan_node *node);
/* Offline: how many PDOs each entry is in. */
void scan_count_maps(struct scan_node *node);
int scan_error_of_send(enum co_err err);
/* A TPDO with AUTO_NOTIFY maps the entry. */
bool scan_is_sent(const struct scan_node *node, const struct od_entry *entry);
/*
 * Where the result so far is SCANOPEN_OK: waits until the TPDO with TX_DONE_PDO that a change of
 * the entry has sent has been on the bus. Under the lock.
 */
int scan_wait_sent(struct scan_node *node, const struct od_entry *entry, int result);

/* ---- scan_file.c ---- */

/* Dictionary and PDOs of a node without any. SCANOPEN_WRONG_PARAMETER, SCANOPEN_OUT_OF_MEMORY */
int scan_make_from_file(struct scan_node *node, const char *path);

/* ---- scan_time.c ---- */

CAN_TIME_OF_DAY scan_time_of(const struct co_event *news);

/* ---- scan_store.c ---- */

/* Offline: 1010h and 1011h are watched where somebody is to be asked. */
void scan_watch_store(struct scan_node *node);
/* Under the network's lock: a SLAVE_VERDICT; false: it is about no such command. */
bool scan_on_store(struct scan_node *node, const struct co_event *event);
/* What the handler has returned; with the news that scan_tell_configuration() got. */
void scan_decide_store(const struct scan_token *token, const struct co_event *news, int result);
/* Between scan_lock() and scan_unlock(): until the daemon has written the file. */
void scan_wait_stored(struct scan_node *node);
void scan_store_work(void *context, const void *element);
/* Under the lock: strings that a reset has brought back. */
void scan_end_texts(struct scan_node *node);

/* ---- scan_handlers.c ---- */

void scan_on_rpdo(struct scan_node *node, const struct co_event *event);
void scan_on_tpdo_wanted(struct scan_node *node, const struct co_event *event);
void scan_pdo_work(void *context, const void *element);

/* One call of an object handler, under no lock. */
struct scan_call {
    int net, node;
    uint64_t time; /* as handlers get it */
    uint16_t index;
    uint8_t sub;
    struct scan_entry handlers;
    union scan_data data;
};
/* Of reception, as the application gets it. */
uint64_t scan_time_for_handlers(const struct scan_node *node, co_us_t time);
void scan_make_call(const struct scan_node *node, const struct od_entry *entry, co_us_t time,
                    struct scan_call *ret_call);
/* One of the handlers must be there. */
int scan_run_call(const struct scan_call *call, void *data);

/* ---- scan_sdo.c ---- */

/* SLAVE_VERDICT, SLAVE_FETCH */
void scan_on_question(struct scan_node *node, const struct co_event *event, co_us_t now);
/* As many as the node's slave has channels; nothing waits. False: no memory. Under the lock. */
bool scan_make_questions(struct scan_node *node);
void scan_sdo_work(void *context, const void *element);

/* ---- scan_domain.c ---- */

/* NULL: no memory. */
struct scan_domain *scan_copy_domain(const struct scan_domain *domain);
/* What is in the file; *ret_bytes is to be freed. Under no lock. */
sdo_abort_t scan_read_domain(const struct scan_domain *domain, uint8_t **ret_bytes,
                             uint32_t *ret_size);
sdo_abort_t scan_error_of_file(enum co_err err);

/* ---- scan_error.c ---- */

/* Under the network's lock. */
void scan_on_emcy(struct scan_node *node, const struct co_event *event);
void scan_emcy_work(void *context, const void *element);
void scan_emcy_lost(void *context, unsigned count);

/* ---- scan_events.c ---- */

/* Under the network's lock: what a node's slave tells. */
void scan_on_node_event(void *context, struct network *network, const struct co_event *event);
/* What the network tells all its nodes. */
void scan_on_net_event(void *context, struct network *network, const struct co_event *event);
void scan_nmt_work(void *context, const void *element);
void scan_nmt_lost(void *context, unsigned count);
/* Its handler wants that kind. */
bool scan_wants(const struct scan_node *node, unsigned long event);
/* Calls it, in a daemon; what it has returned. */
int scan_call_handler(const struct scan_token *token, SLAVE_EVENT *event);
/* EV_CONFIGURATION for a SLAVE_VERDICT. Under the network's lock. */
void scan_tell_configuration(struct scan_node *node, const struct co_event *news);
/* To the node's handler, if it wants that kind. Under the network's lock. */
void scan_tell(struct scan_node *node, unsigned long event, unsigned long arg1, unsigned long arg2);

#endif
