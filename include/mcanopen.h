/*
 * mcanopen: the CANopen manager (CiA 301 and CiA 302-2). Configures, starts and supervises the
 * slaves of one or more CAN networks as an XML file describes them. scanopen.h is the slave side of
 * the same library; both may be used in one process and on one network.
 *
 *   mcanOpenInitialize();
 *   if (mcanOpenConfig("network.xml") != MCANOPEN_OK)
 *       puts(mcanOpenGetErrorText());
 *   else
 *       mcanOpenStart();                  from now on: mcanOpenEvent, mcanOpenReadSDO ...
 *   mcanOpenShutDown();
 *   mcanOpenCleanup();
 *
 * Return values: MCANOPEN_OK or one of the error codes below. Compare with the names, not with
 * numbers. Any function that takes a net returns MCAL_NO_NET for a net (0..255) that is not in the
 * configuration, MCAL_SYS_ERROR before mcanOpenInitialize and MCAL_PARA_ERROR for a NULL pointer or
 * a number out of range; below only what goes beyond that is told.
 *
 * Threads: every function may be called from any thread. While one of mcanOpenInitialize, Config,
 * Start, ShutDown and Cleanup works, these return MCAL_SYS_ERROR in other threads. From a callback
 * (an object or event handler of scanopen.h, the log hook, the end of an SDO request) only those
 * that do not wait: the others are marked "waits" and return MCAL_UNSUPPORTED there at once. After
 * fork() the child may use no function of the library.
 *
 * "Ours" marks what goes beyond the interface of the manual. Pointers to data that the library only
 * reads are const here, where the manual prints them without.
 */
#ifndef MCANOPEN_H
#define MCANOPEN_H

#include "mcanopen_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* error codes ---------------------------------------------------------------------------------- */

#define MCANOPEN_OK 0 /* done, nothing to say */

/* Communication */
#define MCAL_CAN_RX_TIMEOUT    (-1) /* the node did not answer in time */
#define MCAL_CAN_TX_TIMEOUT    (-2) /* the frame could not go out in time: busy bus, no node */
#define MCAL_CAN_TX_ERROR      (-3) /* sending failed: interface down or gone */
#define MCAL_CAN_CONTR_OFF_BUS (-4) /* the controller is bus-off */
#define MCAL_CAN_CONTR_WARN    (-5) /* a send timed out while the controller was error passive */
#define MCAL_CAN_CONTR_BUSY    (-6) /* the queue for frames to send is full */
/* General */
#define MCAL_PARA_ERROR        (-7)  /* an argument, or a value of the XML file, is not valid */
#define MCAL_SYS_ERROR         (-8)  /* wrong order of calls, bad XML, unusable interface */
#define MCAL_NO_NET            (-9)  /* this net is not configured, or went away while waiting */
#define MCAL_OBJ_NO_MEMORY     (-10) /* no memory, thread or other resource of the system */
#define MCAL_NODE_NOT_EXISTEND (-11) /* the node is not in the configuration of this net */
#define MCAL_NO_EVENT          (-12) /* no event is waiting */
#define MCAL_UNSUPPORTED       (-13) /* a call that waits, from a callback */
#define MCAL_NODE_NOT_FREE     (-22) /* not now, the state of manager or node forbids it */
#define MCAL_SDO_QUEUE_FULL    (-23) /* ours: too many SDO requests are under way already */
#define MCAL_SDO_CANCELLED     (-24) /* ours: how a request ends that mcanOpenCancelSDO has ended */
/* SDO transfers */
#define MCAL_WRONG_SERVER_ANSWER (-14) /* the node's answer breaks the SDO protocol */
#define MCAL_TOGGLE_ERROR        (-15) /* the node's segments do not alternate their toggle bit */
#define MCAL_BUFFER_OVERFLOW     (-16) /* the caller's buffer is too small */
#define MCAL_ABORT_DOMAIN        (-17) /* the node aborted the transfer; ERROR_T has its code */
/* Left over from CAL, defined so that programs compile. This implementation never returns them: */
#define MCAL_DOWNLOAD_ABORT_SLAVE (-18) /* there are no CAL slaves */
#define MCAL_WRONG_SLAVE_ANSWER   (-19) /* there are no CAL slaves */
#define MCAL_WRONG_GUARD_ID       (-20) /* CANopen fixes the identifier of guarding */
#define MCAL_NEW_GUARD_PARA       (-21) /* as above, so it cannot differ between files */

/* Configuration files, from mcanOpenConfig; mcanOpenGetErrorText tells file and line */
#define CANOPEN_DCF_INIT_ERROR      (-101) /* a DCF or CCF file cannot be opened */
#define CANOPEN_DCF_OUT_OF_MEMORY   (-102) /* no memory while reading a DCF or CCF file */
#define CANOPEN_DCF_WRONG_NODE_ID   (-103) /* NodeID of the DCF differs from Node_Id of the XML */
#define CANOPEN_DCF_WRONG_BAUDRATE  (-104) /* not of CANopen, or DCF, XML, interface differ */
#define CANOPEN_DCF_MISSING_SECTION (-105) /* there is no section: no EDS or DCF at all */
#define CANOPEN_DCF_WRONG_PARAMETER (-107) /* a keyword has no value or no valid one */
#define CANOPEN_DCF_OUT_OF_RANGE    (-108) /* a value does not fit its data type */
#define CANOPEN_DCF_OUT_OF_LIMITS   (-109) /* a value is not between LowLimit and HighLimit */
#define CANOPEN_DCF_WRONG_NET_NO    (-113) /* more networks than the library can drive */
#define CANOPEN_DCF_WRONG_MODULE_NO (-114) /* a node-ID is not 1..127 */
/* Defined so that programs compile. Real files have these faults, so the reader only warns: */
#define CANOPEN_DCF_MISSING_ENTRY   (-106) /* a keyword that CiA 306 demands is missing */
#define CANOPEN_DCF_DOUBLE_SECTION  (-110) /* a section occurs twice: the later value counts */
#define CANOPEN_DCF_DOUBLE_KEYWORD  (-111) /* a keyword occurs twice: the later value counts */
#define CANOPEN_DCF_UNKNOWN_KEYWORD (-112) /* a keyword is not of CiA 306: it is skipped */

/* events --------------------------------------------------------------------------------------- */

/*
 * Why a node aborted an SDO transfer: the four bytes of its abort code (CiA 301, 7.2.4.3.17), the
 * most significant first. All 0 when the transfer ended in any other way.
 */
typedef struct {
    unsigned char eclass; /* bits 31..24 of the abort code */
    unsigned char code;   /* bits 23..16 */
    unsigned char spec;   /* bits 15..8 */
    unsigned char global; /* bits 7..0 */
} ERROR_T;

/*
 * One message of the manager. event tells what is in it:
 *
 *   bit   31           30           29..8                          7..0
 *         NET_NOT_VAL  NOD_NOT_VAL  PARA: which member of para     message: index into the paraInfo
 *                                   is valid (exactly one bit)     table of that member
 *
 * The value is zero-extended, so with a long of 64 bits it is never negative.
 */
typedef struct {
    long event;
    int net;  /* -1 with NET_NOT_VAL */
    int node; /* -1 with NOD_NOT_VAL */
    union {
        char c;
        unsigned char uc;
        short s;
        unsigned short us;
        int i;
        unsigned int ui;
        long l;
        unsigned long ul;
        struct {
            unsigned short index;
            unsigned short subindex;
            ERROR_T err;
        } write;
        char str[64]; /* always ends with a NUL */
    } para;
} EVENT_T;

#define NET_NOT_VAL 0x80000000UL
#define NOD_NOT_VAL 0x40000000UL
#define PARA        0x3FFFFF00UL
#define PARA_C      0x00000100UL
#define PARA_UC     0x00000200UL
#define PARA_S      0x00000400UL
#define PARA_US     0x00000800UL
#define PARA_I      0x00001000UL
#define PARA_UI     0x00002000UL
#define PARA_L      0x00004000UL
#define PARA_UL     0x00008000UL
#define PARA_WRITE  0x00010000UL
#define PARA_STR    0x00020000UL

/*
 * Messages: the least significant byte of event. Numbers count for each member of para on their
 * own.
 */
/* with PARA_C, para.c */
enum {
    MCANOPEN_MSG_BOOT_ERROR = 1 /* a boot try failed; c: the status letter of CiA 302-2, 'A'..'O' */
};
/* with PARA_UC, para.uc */
enum {
    MCANOPEN_MSG_NODE_STATE = 1,    /* a node has a new NMT state, uc */
    MCANOPEN_MSG_BOOT_UP = 2,       /* a node has sent its boot-up message; uc: 0 */
    MCANOPEN_MSG_NODE_STARTED = 3,  /* the manager has started a node; uc: its NMT state as known */
    MCANOPEN_MSG_MANAGER_STATE = 4, /* node is the manager itself; uc: its new NMT state */
    MCANOPEN_MSG_NETWORK_UP = 5,    /* NOD_NOT_VAL; the network is up; uc: nodes booted */
    MCANOPEN_MSG_NODE_BOOTED = 6,   /* a node's boot ended well; uc: 'L' was running, or 0 */
    MCANOPEN_MSG_BOOT_STEP = 7,     /* the boot of a node goes on; uc: MCANOPEN_STEP_... entered */
    MCANOPEN_MSG_SOFTWARE_UPDATE = 8,    /* the update of a node goes on; uc: MCANOPEN_UPDATE_... */
    MCANOPEN_MSG_NODES_MISSING = 9,      /* the network waits for mandatory nodes; node: the first,
                                            uc: how many; after 5 s, then ever more rarely */
    MCANOPEN_MSG_NETWORK_HALTED = 10,    /* a mandatory node has failed for good; as above */
    MCANOPEN_MSG_FOREIGN_COMMAND = 11,   /* another NMT master commands; uc: MCANOPEN_NMT_..., node:
                                            to whom, or NOD_NOT_VAL: to all */
    MCANOPEN_MSG_REQUESTED_COMMAND = 12, /* a tool commands by 1F82h; as above */
    MCANOPEN_MSG_NOT_STARTED = 13,       /* a node does not follow its start; uc: its NMT state */
    MCANOPEN_MSG_NODE_ID_TAKEN = 14,     /* another device has the manager's node-ID; uc: its NMT
                                            state */
    MCANOPEN_MSG_SYNC_MISSING = 15,      /* NOD_NOT_VAL; the interface does not send SYNC; uc: 0 */
    MCANOPEN_MSG_BUS_BUSY = 16           /* NOD_NOT_VAL; frames wait for the bus; uc: 0; once */
};
/* with PARA_US, para.us */
enum {
    MCANOPEN_MSG_HEARTBEAT_LOST = 1, /* us: the consumer heartbeat time that has passed, ms */
    MCANOPEN_MSG_HEARTBEAT_BACK = 2, /* us: as above */
    MCANOPEN_MSG_BOOT_TIME_OVER = 3, /* NOD_NOT_VAL; mandatory node missing; us: Boot_Time, ms */
    MCANOPEN_MSG_GUARDING_LOST = 4,  /* us: Guard_Time x Life_Time_Factor without an answer, ms */
    MCANOPEN_MSG_GUARDING_BACK = 5   /* us: as above */
};
/* with PARA_I, para.i */
enum {
    MCANOPEN_MSG_BUS_STATE = 1,         /* NOD_NOT_VAL; i: MCANOPEN_BUS_... */
    MCANOPEN_MSG_GUARDING_TOGGLE = 0x22 /* guarding answer with wrong toggle bit; i: how many */
};
/* with PARA_UL, para.ul */
enum {
    MCANOPEN_MSG_EMERGENCY = 1,   /* ul: error code in bits 0..15, error register in bits 16..23 */
    MCANOPEN_MSG_EVENTS_LOST = 2, /* NET_NOT_VAL and NOD_NOT_VAL; ul: events dropped, queue full */
    MCANOPEN_MSG_FRAMES_LOST = 3, /* NOD_NOT_VAL; ul: frames that the interface has dropped */
    MCANOPEN_MSG_FRAMES_UNSENT = 4, /* NOD_NOT_VAL; ul: frames that the bus did not take in 2 s */
    MCANOPEN_MSG_CONFIGURED = 5     /* a node has its configuration; ul: entries written for that */
};
/* with PARA_WRITE, para.write */
enum {
    MCANOPEN_MSG_CONFIGURATION_ABORTED = 1,   /* a node refused a value of its configuration */
    MCANOPEN_MSG_BOOT_READ_ABORTED = 2,       /* a node refused a read that its boot needs */
    MCANOPEN_MSG_SOFTWARE_UPDATE_ABORTED = 3, /* a node refused what its software update needs */
    MCANOPEN_MSG_OBJECT_WRITTEN = 4 /* node is the manager itself: a tool has written to it */
};
/* with PARA_STR, para.str */
enum {
    MCANOPEN_MSG_TEXT = 1 /* what went wrong, cut to 63 characters; the log has all of it */
};

/* of MCANOPEN_MSG_BUS_STATE */
enum {
    MCANOPEN_BUS_ACTIVE = 0,
    MCANOPEN_BUS_WARNING = 1,
    MCANOPEN_BUS_PASSIVE = 2,
    MCANOPEN_BUS_OFF = 3,
    MCANOPEN_BUS_DOWN = 4 /* the interface is down or gone */
};

/* NMT states as mcanOpenGetNodeState, events and records give them (CiA 301, 7.2.8) */
enum {
    MCANOPEN_STATE_OFFLINE = 0x00, /* never heard, lost, or in reset */
    MCANOPEN_STATE_STOPPED = 0x04,
    MCANOPEN_STATE_OPERATIONAL = 0x05,
    MCANOPEN_STATE_PREOPERATIONAL = 0x7F
};

/* NMT commands (CiA 301, 7.2.8.2.1), of MCANOPEN_MSG_FOREIGN_COMMAND and .._REQUESTED_COMMAND */
enum {
    MCANOPEN_NMT_START = 1,
    MCANOPEN_NMT_STOP = 2,
    MCANOPEN_NMT_ENTER_PREOPERATIONAL = 128,
    MCANOPEN_NMT_RESET_NODE = 129,
    MCANOPEN_NMT_RESET_COMMUNICATION = 130
};

/* of MCANOPEN_MSG_SOFTWARE_UPDATE (CiA 302-3): what is asked of the node's program */
enum {
    MCANOPEN_UPDATE_STOP = 2,
    MCANOPEN_UPDATE_CLEAR = 4,
    MCANOPEN_UPDATE_WRITE = 6,
    MCANOPEN_UPDATE_COMPARE = 8,
    MCANOPEN_UPDATE_START = 9
};

/* life of a manager ---------------------------------------------------------------------------- */

/*
 * Prepares the library. To be called first; a second call before mcanOpenCleanup changes nothing.
 *
 *   MCAL_SYS_ERROR      another thread is in one of the calls told above
 *   MCAL_OBJ_NO_MEMORY  no memory
 *   MCAL_UNSUPPORTED    from a callback
 */
MCANOPEN_API int mcanOpenInitialize(void);

/*
 * Ends what still runs (as mcanOpenShutDown) and frees everything, log hook and error text
 * included. Local slaves made with scanopen.h are not touched. Waits for the threads of the manager
 * to end.
 *
 *   MCAL_SYS_ERROR    not initialized
 *   MCAL_UNSUPPORTED  from a callback
 */
MCANOPEN_API int mcanOpenCleanup(void);

/*
 * Reads the XML file cfgFile and every DCF (CiA 306) or CCF (CiA 302-3) file that it names, and
 * opens the CAN interfaces. Sends nothing. On an error all of it is undone, mcanOpenGetErrorText
 * has the first error and the log hook got all of them; another file may then be tried. Waits (file
 * access).
 *
 *   MCAL_SYS_ERROR      not initialized, configured already; the XML file is missing, unreadable or
 *                       malformed; an interface is missing, down or forbidden
 *   MCAL_PARA_ERROR     unknown or duplicate element, value out of range, node-ID given twice
 *   MCAL_OBJ_NO_MEMORY  no memory
 *   CANOPEN_DCF_...     as told at each code; WRONG_BAUDRATE also for an interface, or a network
 *                       that a local slave has opened, with another bit rate
 *   MCAL_UNSUPPORTED    from a callback
 */
MCANOPEN_API int mcanOpenConfig(const char *cfgFile);

/*
 * Starts the manager on every configured network: initial reset, Boot_Delay, then the boot of all
 * slaves side by side (CiA 302-2). Returns at once, or, with Wait_For_Startup TRUE in a network,
 * when each slave of that network has been tried once or the bus is lost. What happens is told by
 * events. Without a configuration, a second time or from a callback it does nothing but log an
 * error; where the system has no threads left, it logs that and shuts down (as mcanOpenShutDown).
 */
MCANOPEN_API void mcanOpenStart(void);

/*
 * Ends the manager and gives the networks back. No NMT command goes out: the slaves keep their
 * states and local slaves their network. Calls that wait in other threads return within 100 ms.
 * mcanOpenConfig may follow. Waits.
 *
 *   MCAL_SYS_ERROR    not initialized, or nothing is configured
 *   MCAL_UNSUPPORTED  from a callback
 */
MCANOPEN_API int mcanOpenShutDown(void);

/*
 * The version of the library: level in bits 12..15, revision in bits 8..11, change in bits 0..7.
 * Needs no initialization.
 *
 *   MCAL_PARA_ERROR  version is NULL
 */
MCANOPEN_API int mcanOpenGetVersion(unsigned short *version);

/* what happens --------------------------------------------------------------------------------- */

/*
 * Takes the oldest event, of any network. With wait 0 it returns at once; with wait 1 it waits for
 * an event. Several threads may wait, each event goes to one of them. The queue has room for 4096:
 * where the application does not fetch events in time, new ones are dropped and counted, and
 * MCANOPEN_MSG_EVENTS_LOST stands in their place and tells how many are missing there.
 * docs/events.md lists all events and what to do about them.
 *
 *   MCAL_NO_EVENT     nothing there (wait 0)
 *   MCAL_NO_NET       nothing is configured, or the manager was shut down while waiting
 *   MCAL_SYS_ERROR    not initialized
 *   MCAL_PARA_ERROR   event is NULL, wait is neither 0 nor 1
 *   MCAL_UNSUPPORTED  wait 1 from a callback
 */
MCANOPEN_API int mcanOpenEvent(EVENT_T *event, int wait);

/*
 * Ours: how many events the queue had no room for since mcanOpenConfig, told by
 * MCANOPEN_MSG_EVENTS_LOST already or not yet.
 *
 *   MCAL_SYS_ERROR   not initialized
 *   MCAL_NO_NET      nothing is configured
 *   MCAL_PARA_ERROR  count is NULL
 */
MCANOPEN_API int mcanOpenGetLostEvents(unsigned int *count);

/*
 * The NMT state of a node, 1..127, as last reported by it (boot-up, heartbeat, guarding): 0x00
 * offline, 0x04 stopped, 0x05 operational, 0x7F pre-operational; with the manager's own node-ID its
 * own state. Without error control of the node it is the state that the manager last commanded.
 *
 *   MCAL_NODE_NOT_EXISTEND  the node is not in the configuration
 */
MCANOPEN_API int mcanOpenGetNodeState(int net, int nodeID, int *state);

/* object dictionary access --------------------------------------------------------------------- */

/*
 * Reads the object index (0..0xFFFF), subindex (0..0xFF) of node modID (1..127) by SDO (CiA 301,
 * 7.2.4). *len is the size of buffer in bytes before, and the number of bytes read after the call.
 * The bytes are as the node has sent them, little-endian. The time-out for each answer is
 * SDO_Timeout of the node; for nodes that are not in the configuration, which may be read as well,
 * 200 ms. The time starts when the transfer's turn has come: a node serves one at a time. With the
 * manager's own node-ID its own dictionary is read, over the bus as well. error may be NULL. Waits.
 *
 * subindex | TYP_BLOCK (ours) asks for a block transfer, with SDO_Block_Size segments in a block
 * where the configuration has it, else 127. A node that refuses that is read in segments; until it
 * boots again it is not asked for blocks any more.
 *
 *   MCAL_ABORT_DOMAIN         the node aborted; *error has its code
 *   MCAL_BUFFER_OVERFLOW      the data is longer than *len: aborted with 05040005h, buffer is
 *                             untouched, *len is the size needed where the node has told it
 *   MCAL_CAN_RX_TIMEOUT       no answer in time
 *   MCAL_TOGGLE_ERROR, MCAL_WRONG_SERVER_ANSWER   the node breaks the protocol; aborted
 *   MCAL_CAN_TX_TIMEOUT, MCAL_CAN_TX_ERROR, MCAL_CAN_CONTR_OFF_BUS, MCAL_CAN_CONTR_WARN
 *                             the request could not be sent, as told at each code
 *   MCAL_OBJ_NO_MEMORY        no memory for the data
 *   MCAL_NODE_NOT_FREE        the manager is not started
 *   MCAL_NO_NET               also: the manager was shut down meanwhile
 *   MCAL_UNSUPPORTED          from a callback
 */
MCANOPEN_API int mcanOpenReadSDO(unsigned short net, unsigned short modID, int index, int subindex,
                                 void *buffer, int *len, ERROR_T *error);

/*
 * Writes to the object index, subindex of node modID by SDO; ranges, waiting and errors as in
 * mcanOpenReadSDO, but 2000 ms for nodes that are not in the configuration.
 *
 * type is TYP_...: where it has a size of its own and len is 0, that many bytes are written, else
 * len bytes (1 and up). Up to 4 bytes go expedited, more in segments. TYP_INDICATE_SIZE and
 * TYP_INDICATE_NO_SIZE tell whether the first frame carries the size; without them it does when
 * expedited and in blocks, and does not in segments. TYP_BLOCK (ours) asks for a block transfer,
 * whatever the length; a node that refuses that is written as without, and remembered as in
 * mcanOpenReadSDO. A transfer is never repeated once data was sent.
 *
 *   MCAL_PARA_ERROR  also: unknown type or flags, both size flags, len < 0, len 0 for a type
 *                    without a size
 */
MCANOPEN_API int mcanOpenWriteSDO(unsigned short net, unsigned short modID, int index, int subindex,
                                  int type, const void *buffer, int len, ERROR_T *error);

/* object dictionary access without waiting (ours) ------------------------------------------------- */

/* How an SDO request has ended. It and what it points to are valid during the call that gets it. */
typedef struct {
    int net;
    int node;
    int index;
    int subindex;
    int write;           /* 1: of mcanOpenWriteSDOAsync */
    unsigned int number; /* as the call that made it has told */
    int result;          /* as mcanOpenReadSDO or mcanOpenWriteSDO would return, see there */
    int len;             /* read: bytes at data; with MCAL_BUFFER_OVERFLOW the size needed, or 0 */
    const void *data;    /* read: what the node has sent; NULL where result is not MCANOPEN_OK */
    ERROR_T error;       /* with MCAL_ABORT_DOMAIN the node's abort code */
} SDO_RESULT_T;

/* Is told the end of a request. */
typedef void (*MCANOPEN_SDO_DONE_T)(void *context, const SDO_RESULT_T *result);

/* An SDO request. Nothing of it needs to stay when the call has returned: data is copied. */
typedef struct {
    int size; /* in: sizeof(SDO_REQUEST_T) of the caller, so that the structure can grow */
    int net;
    int node;                 /* 1..127 */
    int index;                /* 0..0xFFFF */
    int subindex;             /* 0..0xFF; read: | TYP_BLOCK, as in mcanOpenReadSDO */
    int type;                 /* write: as in mcanOpenWriteSDO */
    const void *data;         /* write: what to write */
    int len;                  /* write: as in mcanOpenWriteSDO; read: at most so many bytes */
    MCANOPEN_SDO_DONE_T done; /* gets the end */
    void *context;            /* its first argument */
} SDO_REQUEST_T;

/* Requests that may be under way at a time in each network. */
#define MCANOPEN_SDO_REQUESTS 256

/*
 * As mcanOpenReadSDO and mcanOpenWriteSDO, but they do not wait: request->done is told the end,
 * exactly once for each request that was taken (MCANOPEN_OK), and not at all for others. With the
 * calls that wait, requests to one node come in turn; the time-out of each starts when its turn has
 * come. Those to different nodes go on side by side.
 *
 * number, which may be NULL, gets what mcanOpenCancelSDO needs. It is there before done is called;
 * that may be before this returns.
 *
 * done is called by the control daemon, a thread of the library, one after the other for all
 * networks, and never while the library holds a lock: a slow one delays the others and the log
 * hook, not the protocol. It is a callback, in which calls that wait are refused; new requests and
 * mcanOpenCancelSDO work. mcanOpenShutDown ends all requests that are under way with
 * MCAL_NO_NET, and returns when all of them were told.
 *
 *   MCAL_PARA_ERROR      also: request->size is too small, done is NULL, len < 0; writes: as in
 *                        mcanOpenWriteSDO
 *   MCAL_SDO_QUEUE_FULL  MCANOPEN_SDO_REQUESTS of this network are under way: once more when one
 *                        of them has been told
 *   MCAL_OBJ_NO_MEMORY   no memory for its data
 *   MCAL_NODE_NOT_FREE   the manager is not started
 *   MCAL_NO_NET, MCAL_SYS_ERROR   as in all functions that take a net
 */
MCANOPEN_API int mcanOpenReadSDOAsync(const SDO_REQUEST_T *request, unsigned int *number);
MCANOPEN_API int mcanOpenWriteSDOAsync(const SDO_REQUEST_T *request, unsigned int *number);

/*
 * Ends a request of this net, under way or waiting for its turn. Its end is told as any other,
 * marked as cancelled. A node in the middle of a transfer gets an abort. Does not wait.
 *
 *   MCAL_NO_EVENT       no such request: it has ended, or was cancelled, told or not yet
 *   MCAL_NODE_NOT_FREE  the manager is not started
 */
MCANOPEN_API int mcanOpenCancelSDO(int net, unsigned int number);

/* NMT control ---------------------------------------------------------------------------------- */

/* Kept for old programs. Does nothing, always MCANOPEN_OK. */
MCANOPEN_API int mcanOpenNodeControl(int net, int nodeID, long flags);

/*
 * NMT commands (CiA 301, 7.2.8.2.1) to a node of the configuration, 1..127. They do not wait: the
 * frame goes out at once or stands in the queue, where it is given up after 2 s
 * (MCANOPEN_MSG_FRAMES_UNSENT). The change of state is told by events.
 *
 * nodeID 0 (ours) addresses all nodes, with one frame. The manager's own node-ID changes the state
 * of the manager: with NMT_Auto_Operational FALSE, mcanOpenStartNode(net, Manager_Node_Id) is how
 * the application lets the network start; with NMT_Master FALSE it is all that may be commanded. No
 * slave is started before the manager is operational.
 *
 *   Start       NMT start remote node
 *   Stop        NMT stop remote node
 *   Reset       NMT reset node, whatever NMT_Reset_Node and NMT_Reset_All say: these are for the
 *               resets that the manager decides on; where the node is booted by the manager
 *               (NMT_Auto_Start_Slave) it is configured and started again
 *   EnterPreop  NMT enter pre-operational
 *
 *   MCAL_NODE_NOT_EXISTEND  the node is not in the configuration
 *   MCAL_NODE_NOT_FREE      not now: the manager is not started, not the NMT master or busy with
 *                           the boot of the node or, where it is meant itself or all are, of the
 *                           network; start before the manager is operational
 *   MCAL_CAN_TX_ERROR, MCAL_CAN_CONTR_OFF_BUS, MCAL_CAN_CONTR_BUSY   the command could not be sent,
 *                           as told at each code
 */
MCANOPEN_API int mcanOpenStartNode(int net, int nodeID);
MCANOPEN_API int mcanOpenStopNode(int net, int nodeID);
MCANOPEN_API int mcanOpenResetNode(int net, int nodeID);
MCANOPEN_API int mcanOpenEnterPreop(int net, int nodeID);

/* ours ----------------------------------------------------------------------------------------- */

/* levels of log texts */
enum {
    MCANOPEN_LOG_ERROR = 0,
    MCANOPEN_LOG_WARNING = 1,
    MCANOPEN_LOG_INFO = 2 /* the steps of the boot */
};

/* Gets one line of text without newline; the text is valid during the call. */
typedef void (*MCANOPEN_LOG_T)(void *context, int level, const char *text);

/*
 * Sets who gets the texts of the library; NULL: errors and warnings go to stderr, as without this
 * call. The hook is called from a thread of the library or from within mcanOpenConfig, never while
 * the library holds a lock; from several threads at a time where there are several networks. It
 * stays until mcanOpenCleanup. Calls that have begun may still reach the old hook. Needs no
 * initialization.
 */
MCANOPEN_API int mcanOpenSetLog(MCANOPEN_LOG_T hook, void *context);

/*
 * The first error of the last mcanOpenConfig as one line, "network.xml:14: error: ...", or "".
 * Valid until the next mcanOpenConfig or mcanOpenCleanup.
 */
MCANOPEN_API const char *mcanOpenGetErrorText(void);

/* Room for the longest text of mcanOpenEventText, its end included. */
#define MCANOPEN_EVENT_TEXT_SIZE 256

/*
 * Writes a whole event as one line without newline, "Net: 1 Node: 5 guarding toggle error no 2", at
 * most size bytes with the end. Needs no initialization.
 *
 *   MCAL_PARA_ERROR       event or text is NULL, size < 1, or event has not exactly one PARA bit of
 *                         those above; text, where there is one, is then ""
 *   MCAL_BUFFER_OVERFLOW  the text was cut to fit
 */
MCANOPEN_API int mcanOpenEventText(const EVENT_T *event, char *text, int size);

/* where the boot of a node stands */
enum {
    MCANOPEN_STEP_IDLE = 0, /* not begun, or not booted by the manager */
    MCANOPEN_STEP_RESET = 1,
    MCANOPEN_STEP_DEVICE_TYPE = 2,         /* 1000h */
    MCANOPEN_STEP_IDENTITY = 3,            /* 1018h */
    MCANOPEN_STEP_CHECK_CONFIGURATION = 4, /* 1020h */
    MCANOPEN_STEP_CONFIGURE = 5,
    MCANOPEN_STEP_SAVE = 6, /* 1010h */
    MCANOPEN_STEP_ERROR_CONTROL = 7,
    MCANOPEN_STEP_READY = 8,        /* booted, waits for its start */
    MCANOPEN_STEP_STARTED = 9,      /* booted and started */
    MCANOPEN_STEP_RETRY = 10,       /* waits to try again */
    MCANOPEN_STEP_FAILED = 11,      /* will not try again by itself */
    MCANOPEN_STEP_CHECK_STATE = 12, /* between IDENTITY and CHECK_CONFIGURATION: is it running? */
    MCANOPEN_STEP_CHECK_SOFTWARE = 13, /* behind that; 1F56h */
    MCANOPEN_STEP_UPDATE_SOFTWARE = 14,
    MCANOPEN_STEP_RESTORE = 15 /* 1011h, between CHECK_CONFIGURATION and CONFIGURE */
};

/* How the boot of a node goes or went. */
typedef struct {
    int size;      /* in: sizeof(BOOT_RECORD_T) of the caller, so that the structure can grow */
    int mandatory; /* 1: NMT_Mandatory_Slave */
    int state;     /* NMT state as in mcanOpenGetNodeState */
    int step;      /* MCANOPEN_STEP_... */
    char letter;   /* CiA 302-2 status letter of the last try; 'L': is running; 0: none */
    char booted;   /* 1: the boot ended well */
    unsigned short index; /* object of the last error or abort; 0: none */
    unsigned short subindex;
    unsigned int abortCode; /* SDO abort code of it; 0: none */
    unsigned int expected;  /* value in the configuration where the two differ */
    unsigned int actual;    /* value read from the node */
    unsigned int attempts;  /* boots that failed since the last one that ended well */
    char name[64];          /* <Name> of the node, or "" */
    char text[256];         /* what is missing or went wrong and what to do, one line, or "" */
    /*
     * Behind the first version. failed...: the last boot that failed, kept when the node has booted
     * since, until mcanOpenShutDown; all 0 where none has.
     */
    unsigned int failures; /* boots that failed since mcanOpenConfig */
    int failedStep;        /* MCANOPEN_STEP_... */
    char failedLetter;     /* CiA 302-2 status letter */
    char tried;            /* 1: a boot has ended since the network was started, well or not */
    char keptAlive;        /* 1: found operational and left so (NMT_Check_Nodestate) */
    char reserved;
    unsigned short failedIndex;
    unsigned short failedSubindex;
    unsigned int failedAbortCode;
    unsigned int failedExpected;
    unsigned int failedActual;
    unsigned int failedEntry; /* of the configuration, from 1, in MCANOPEN_STEP_CONFIGURE; or 0 */
    unsigned int failedLine;  /* of the DCF file that this entry comes from; 0: not known */
    unsigned int entries;     /* of the node's configuration */
    uint64_t failedTime;      /* us of CLOCK_MONOTONIC */
    uint64_t bootedTime;      /* the last boot that ended well, likewise; 0: none has */
    char failedText[256];     /* what went wrong and what to do, one line, or "" */
    char file[128];           /* DCF or CCF file of the node as the XML file has it, or "" */
} BOOT_RECORD_T;

/*
 * Tells how the boot of node nodeID (1..127) stands. Set record->size first; no more bytes are
 * written.
 *
 *   MCAL_NODE_NOT_EXISTEND  the node is not in the configuration
 *   MCAL_PARA_ERROR         also: record->size is below that of the first version of the structure
 */
MCANOPEN_API int mcanOpenGetBootRecord(int net, int nodeID, BOOT_RECORD_T *record);

#ifdef __cplusplus
}
#endif

#endif
