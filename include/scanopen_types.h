/*
 * The constants and structures of scanopen.h, which includes this file: do not include it yourself.
 * "Ours" marks what goes beyond the interface of the manual.
 */
#ifndef SCANOPEN_TYPES_H
#define SCANOPEN_TYPES_H

#include "mcanopen_types.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* error codes ---------------------------------------------------------------------------------- */

#define SCANOPEN_OK                  0       /* done, nothing to say */
#define SCANOPEN_WRONG_INDEX         (-1001) /* no such object */
#define SCANOPEN_WRONG_SUBINDEX      (-1002) /* the object has no such sub-index */
#define SCANOPEN_OUT_OF_MEMORY       (-1003) /* no memory or other resource of the system */
#define SCANOPEN_WRONG_BAUDRATE      (-1004) /* not of CANopen, or the network has another */
#define SCANOPEN_CANNOT_START_DAEMON (-1005) /* a thread could not be started */
#define SCANOPEN_WRONG_PARAMETER     (-1006) /* an argument is not valid */
#define SCANOPEN_VALUE_TOO_HIGH      (-1007) /* above the maximum of the entry */
#define SCANOPEN_VALUE_TOO_LOW       (-1008) /* below the minimum of the entry */
#define SCANOPEN_WRONG_TYPE          (-1009) /* not for a dictionary, or not the entry's */
#define SCANOPEN_WRONG_OBJECT_TYPE   (-1010) /* none of OBJ_VAR, OBJ_ARRAY, OBJ_RECORD */
#define SCANOPEN_PDO_MAPPING_ERROR   (-1011) /* a mapped entry is missing or not mappable */
#define SCANOPEN_TOO_MANY_OBJECTS    (-1012) /* more than there was room asked for */
#define SCANOPEN_WRONG_NODESTATE     (-1013) /* not in this NMT state */
#define SCANOPEN_SERVICE_NOT_ALLOWED (-1014) /* not for this PDO, not now, or not from a callback */
#define SCANOPEN_LENGTH_MISMATCH     (-1015) /* the PDO came with another length than its mapping */
#define SCANOPEN_INIT_ERRORS         (-1016) /* the CAN interface cannot be used */
#define SCANOPEN_INVALID_HANDLE      (-1017) /* the handle is not, or no longer, valid */
#define SCANOPEN_ACCESS_ERROR        (-1018) /* the access rights of the entry forbid it */
#define SCANOPEN_PDO_PARAMETER_ERROR (-1019) /* a communication parameter of the PDO is not valid */
#define SCANOPEN_NOT_IMPLEMENTED     (-1020) /* not in this version */
#define SCANOPEN_INHIBITED           (-1021) /* a warning: stored, goes out later */
#define SCANOPEN_RX_TIMEOUT          (-1022) /* ours: no data in time */
#define SCANOPEN_TX_TIMEOUT          (-1023) /* ours: the frame could not go out in time */

/* handles and states --------------------------------------------------------------------------- */

/*
 * Handles are opaque: never dereference them. They stay valid until what they name is deleted, and
 * are told apart from those of a successor.
 */
typedef struct canopen_node_handle *HNODE;
typedef struct canopen_pdo_handle *HPDO;
typedef struct canopen_dictionary_handle *HDICT;
typedef HNODE HNDO;
typedef HNODE HND0;

/* NMT states of a local node (CiA 301, 7.3.2.2). */
enum {
    NodeInit = 0x00, /* created or reset, not on the bus */
    NodeOffline = NodeInit,
    NodeStopped = 0x04,
    NodeOperational = 0x05,
    NodePreOperational = 0x7F
};

/* States to wait for, to be combined (canOpenWaitForNodeState). */
#define WFNS_INIT            0x01
#define WFNS_STOPPED         0x02
#define WFNS_PRE_OPERATIONAL 0x04
#define WFNS_OPERATIONAL     0x08

/* networks ------------------------------------------------------------------------------------- */

/* Fill with zeros before use. */
typedef struct {
    unsigned long ulOptions;    /* the flags below */
    const char *pNetName;       /* for messages; may be NULL */
    unsigned short usBaudrate;  /* kbit/s: 10, 20, 50, 100, 125, 250, 500, 800 or 1000, or: */
    unsigned short usDebugMask; /* as the high word of Debug_Mask, docs/network-xml.md */
    short sPrioNMT;             /* thread priorities, used with THREAD_PRIOS_OVERWRITE: */
    short sPrioSDO;             /* 0 (lowest) .. 31, or, with THREAD_PRIOS_NATIVE, */
    short sPrioPDO;             /* 1..99 of SCHED_FIFO and 0 for the normal scheduler */
    short sPrioEMCY;
    unsigned long ulReserved[4]; /* ours: 0 */
} SLAVE_NET_INFO;

#define BAUDRATE_AS_IT_IS 0xFFFFU /* ours: whatever the interface has */

#define THREAD_PRIOS_OVERWRITE 0x01UL
#define THREAD_PRIO_OVERWRITE  THREAD_PRIOS_OVERWRITE
#define THREAD_PRIOS_NATIVE    0x02UL
#define NORMALIZE_TIMESTAMPS   0x04UL /* object handlers get microseconds instead of nanoseconds */

/* node events ---------------------------------------------------------------------------------- */

/*
 * Kinds of events: bits of SLAVE_NODE_INFO.ulEventMask, one of them in SLAVE_EVENT.ulEvent.
 *
 *   ulEvent               ulArg1                   ulArg2 or pArg2
 *   EV_GUARDING           EV_START, EV_STOP        -        life guarding begins with a request,
 *                                                           ends by 100Ch, 100Dh, 1017h or a reset
 *                         EV_TIMEOUT               -        the life time passed without request
 *   EV_STATE_CHANGE       new NMT state            -        NodeStopped ...
 *   EV_RESET              EV_COMMUNICATION or      EV_BEGIN, EV_END; for information only
 *                         EV_APPLICATION
 *   EV_CONFIGURATION      EV_STORE, EV_RESTORE     sub-index of 1010h, 1011h; the answer to the SDO
 *                                                  client waits for the handler; its return
 *                                                  value is that of an object handler
 *   EV_CAN                EV_CONTROLLER_OK         -        back from one of these two:
 *                         EV_CONTROLLER_WARN       -        error passive
 *                         EV_CONTROLLER_BUS_OFF    -        bus-off, or (ours) interface down
 *                         EV_FIFO_OVERRUN          frames lost by the interface (ours)
 *                         EV_PDO_FIFO_OVERRUN      PDOs lost in the PDO daemon's queue
 *                         EV_PDO_RX_ERROR          never: such errors are states of the bus
 *                         EV_PDO_NOT_PROCESSED     number of the PDO, too short for its mapping
 *                         EV_PDO_LENGTH_EXCEEDED   number of the PDO, longer than its mapping
 *   EV_EMCY               node-ID of the producer  pArg2: SLAVE_EMCY *, valid during the call
 *   EV_CONSUMER_HEARTBEAT EV_START                 node-ID of the producer: monitoring begins with
 *                                                  its heartbeat, also after the next two
 *                         EV_BOOTUP                node-ID: its boot-up message
 *                         EV_TIMEOUT (ours)        node-ID: its heartbeat is lost
 *                         EV_STOP                  node-ID: monitoring ends by 1016h or a reset
 *   EV_WRITE_DICTIONARY   index                    sub-index written by an SDO client
 *   EV_SYNC (ours)        EV_TIMEOUT               SYNC frames of this producer missing on the bus
 *   EV_HANDLER (ours)     EV_TIMEOUT               index << 8 | sub-index: an object handler
 *                                                  gave no verdict within 1 s; the SDO write
 *                                                  was refused
 *   EV_TIME (ours)        -                        pArg2: CAN_TIME_OF_DAY *, valid during the call:
 *                                                  TIME was received
 */
#define EV_GUARDING           0x00000001UL
#define EV_STATE_CHANGE       0x00000002UL
#define EV_RESET              0x00000004UL
#define EV_CONFIGURATION      0x00000008UL
#define EV_CAN                0x00000010UL
#define EV_EMCY               0x00000020UL
#define EV_CONSUMER_HEARTBEAT 0x00000040UL
#define EV_WRITE_DICTIONARY   0x00000080UL
#define EV_SYNC               0x00000100UL /* ours */
#define EV_HANDLER            0x00000200UL /* ours */
#define EV_TIME               0x00000400UL /* ours */
#define EV_ALL                0xFFFFFFFFUL /* ours: as a mask */

#define EV_START               1
#define EV_STOP                2
#define EV_TIMEOUT             3
#define EV_BOOTUP              4
#define EV_COMMUNICATION       5
#define EV_APPLICATION         6
#define EV_BEGIN               7
#define EV_END                 8
#define EV_STORE               9
#define EV_RESTORE             10
#define EV_CONTROLLER_OK       11
#define EV_CONTROLLER_WARN     12
#define EV_CONTROLLER_BUS_OFF  13
#define EV_FIFO_OVERRUN        14
#define EV_PDO_FIFO_OVERRUN    15
#define EV_PDO_RX_ERROR        16
#define EV_PDO_NOT_PROCESSED   17
#define EV_PDO_LENGTH_EXCEEDED 18

typedef struct {
    unsigned short usNetNo;
    unsigned short usModId; /* node-ID of the local slave */
    unsigned long ulEvent;
    unsigned long ulArg1;
    union {
        unsigned long ulArg2;
        void *pArg2;
    } arg;
} SLAVE_EVENT;

/* A received EMCY object (CiA 301, 7.2.7); ours. */
typedef struct {
    unsigned long ulCobId;
    unsigned short usNodeId; /* CAN-ID 081h..0FFh: that - 80h; else the sub-index of 1028h */
    unsigned char ucData[8]; /* error code (low byte first), error register, 5 bytes of the maker */
    uint64_t ullTimestamp;   /* as object handlers get it */
} SLAVE_EMCY;

/* Returns SCANOPEN_OK; only for EV_CONFIGURATION does the value count. */
typedef int (*PFN_COS_EVENT_HANDLER)(SLAVE_EVENT *pEvent);

/*
 * The handler of canOpenCreateNode: net and node in one number (take it apart with the two macros),
 * ulEvent, ulArg1, ulArg2. It gets EV_GUARDING, EV_STATE_CHANGE and EV_RESET only.
 */
typedef int (*PFN_COS_EVENT_HANDLER_OLD)(int NetAndNode, int Event, int Arg1, int Arg2);

#define CANOPEN_NET(NetAndNode)  (((NetAndNode) >> 8) & 0xFF)
#define CANOPEN_NODE(NetAndNode) ((NetAndNode)&0xFF)

/* nodes ---------------------------------------------------------------------------------------- */

/*
 * Flags of ulOptions, and of Options in canOpenCreateNode: which objects of the communication
 * profile a node has. 1000h, 1001h, 1014h, 1015h, 1018h and the PDO parameters are always there.
 */
#define BLOCK_TRANSFER         0x00000001 /* SDO servers serve block transfers */
#define STATE_REGISTER         0x00000002 /* 1002h */
#define ERROR_REGISTER         0x00000004 /* 1003h with ucMaxErrors entries */
#define ADDITIONAL_PDOS        0x00000008 /* 1004h; canOpenCreateNode only */
#define SYNCHRON_PDOS          0x00000010 /* 1005h to 1007h */
#define MANUFACTURER_INFO      0x00000020 /* 1008h to 100Ah */
#define GUARDING               0x00000040 /* 100Ch, 100Dh; 100Eh with canOpenCreateNode */
#define PARAMETER_STORE        0x00000080 /* 1010h, 1020h */
#define PARAMETER_RESET        0x00000100 /* 1011h */
#define ADDITIONAL_SDOS        0x00000200 /* 1201h .. with ucServerSDO > 1: clients open them */
#define SYNC_GENERATION        0x00000400 /* 1005h to 1007h, as SYNC producer */
#define CONSUMER_HEARTBEAT     0x00000800 /* 1016h with ucMaxConsumerHB entries */
#define PRODUCER_HEARTBEAT     0x00001000 /* 1017h */
#define PRODUCER_HERTBEAT      PRODUCER_HEARTBEAT
#define EMCY_CONSUMER          0x00002000 /* 1028h */
#define ERROR_BEHAVIOUR_OBJECT 0x00004000 /* 1029h */
#define PDO_ACCEPT_LONG        0x00010000 /* ours: a PDO longer than its mapping is taken */
#define AUTO_START             0x00020000 /* ours: canOpenActivateNode goes on to operational */
#define TIME_STAMP             0x00040000 /* ours: 1012h */

#define DEFAULT_SYNC_COBID              0x80UL
#define SYNC_PRODUCE                    0x40000000UL /* bit of ulSyncCobID */
#define DEFAULT_TIME_COBID              0x100UL      /* ours */
#define TIME_CONSUME                    0x80000000UL /* ours: bits of ulTimestampCobId */
#define TIME_PRODUCE                    0x40000000UL
#define DEFAULT_EMCY_COBID              0UL /* 80h + node-ID */
#define DEFAULT_EMCY_INHIBIT_TIME       0
#define DEFAULT_PRODUCER_HEARTBEAT_TIME 0

/* Entries of pulListCHBT in the format of 1016h: node-ID 1..127, time 1..65535 ms. */
#define CHBT_ENTRY(Node, Time)                                                                     \
    (MCANOPEN_CAST(unsigned long, Node) << 16 | (MCANOPEN_CAST(unsigned long, Time) & 0xFFFFUL))
#define END_OF_CHBT_LIST 0xFFFFFFFFUL

/* What a serious error does to the NMT state (1029h:01). */
#define ERROR_BEHAVIOUR_DEFAULT   0 /* operational becomes pre-operational */
#define ERROR_BEHAVIOUR_NO_CHANGE 1
#define ERROR_BEHAVIOUR_STOP      2 /* stopped */

/*
 * What a node is. Fill with zeros before use; members whose flag is not set are not looked at.
 * Strings are copied.
 */
typedef struct {
    unsigned long ulOptions;
    unsigned long ulEventMask;  /* the kinds of events for the handler, EV_... combined; 0: none */
    unsigned long ulDeviceType; /* 1000h */
    unsigned short usRxPDO;     /* how many received PDOs at most, 0..512 */
    unsigned short usTxPDO;     /* how many transmitted PDOs at most, 0..512 */
    unsigned char ucServerSDO;  /* ADDITIONAL_SDOS: SDO servers, 1..127, the first one included */
    unsigned char ucClientSDO;  /* reserved */
    unsigned char ucMaxErrors;  /* ERROR_REGISTER: entries of 1003h, 1..127 */
    unsigned char ucMaxIdentityObject; /* entries of 1018h, 1..4 */
    unsigned long ulVendorId;          /* 1018h:01 */
    unsigned long ulProductCode;       /* 1018h:02 */
    unsigned long ulRevisionNumber;    /* 1018h:03 */
    unsigned long ulSerialNumber;      /* 1018h:04 */
    __extension__ union {              /* MANUFACTURER_INFO: 1008h */
        const char *pszDeviceName;
        const char *pszDevicename;
    };
    const char *pszHwVersion;         /* MANUFACTURER_INFO: 1009h */
    const char *pszSwVersion;         /* MANUFACTURER_INFO: 100Ah */
    unsigned long ulSyncCobID;        /* SYNCHRON_PDOS, SYNC_GENERATION: 1005h */
    unsigned long ulCyclePeriod;      /* SYNC_GENERATION: 1006h, us; 0: no SYNC */
    unsigned long ulSyncWindowLen;    /* reserved */
    unsigned long ulTimestampCobId;   /* TIME_STAMP: 1012h; 0: consumer of DEFAULT_TIME_COBID */
    unsigned long ulEmcyCobId;        /* 1014h; 0: DEFAULT_EMCY_COBID */
    const unsigned long *pulListCHBT; /* CONSUMER_HEARTBEAT: CHBT_ENTRY ... END_OF_CHBT_LIST */
    unsigned short usEmcyInhibit;     /* 1015h, ms, at most 6553 */
    unsigned short usGuardTime;       /* GUARDING: 100Ch, ms */
    __extension__ union {             /* PRODUCER_HEARTBEAT: 1017h, ms; 0: off */
        unsigned short usProducerHbTime;
        unsigned short usProducerHBTime;
    };
    __extension__ union { /* frames in the PDO daemon's queue; 0: 256 */
        unsigned short usPdoRxQueueSize;
        unsigned short usPdoRxQueusize;
    };
    __extension__ union { /* GUARDING: 100Dh */
        unsigned char ucLifeTime;
        unsigned char ucLifetime;
    };
    unsigned char ucMaxConsumerHB;  /* CONSUMER_HEARTBEAT: entries of 1016h, 1..127 */
    unsigned char ucErrorBehaviour; /* ERROR_BEHAVIOUR_OBJECT: 1029h:01 */
    unsigned char ucMaxMapped;      /* PDOs an entry with MULTI_MAP may be in; 0: 8 */
    unsigned long ulReserved[8];    /* ours: 0 */
} SLAVE_NODE_INFO;
/* object dictionary ---------------------------------------------------------------------------- */

/* Kinds of objects (CiA 301, 7.4.3). */
#define OBJ_VAR    7
#define OBJ_ARRAY  8
#define OBJ_RECORD 9

/*
 * Descriptors: data types as chars with a 0 at the end. Use MAP_... where there is one type, and
 * const char descriptor[] = {TYP_UINT8, TYP_INT32, TYP_INT16, 0}; for records.
 */
#define MAP_BOOL            "\x01"
#define MAP_INT8            "\x02"
#define MAP_INT16           "\x03"
#define MAP_INT32           "\x04"
#define MAP_UINT8           "\x05"
#define MAP_UINT16          "\x06"
#define MAP_UINT32          "\x07"
#define MAP_FLOAT           "\x08"
#define MAP_VIS_STRING      "\x09"
#define MAP_OCT_STRING      "\x0A"
#define MAP_TIME_OF_DAY     "\x0C"
#define MAP_TIME_DIFFERENCE "\x0D"
#define MAP_DOMAIN          "\x0F"
#define MAP_DOUBLE          "\x11" /* ours */
#define MAP_INT64           "\x15" /* ours */
#define MAP_UINT64          "\x1B" /* ours */
#define MAP_CHAR            "\x41"

/* Properties of an entry, to be combined. */
#define READ_ACCESS  0x0001 /* SDO clients may read it */
#define WRITE_ACCESS 0x0002 /* SDO clients may write it */
#define MAPPABLE     0x0004 /* it may be in one PDO */
#define MULTI_MAP    0x0008 /* it may be in up to ucMaxMapped PDOs */

/*
 * Numbers: present value, power-on value, limits. minval and maxval both 0: no limits.
 */
typedef struct {
    uint8_t val, defval; /* 0 or 1 */
} RecBool;

typedef struct {
    int8_t val, defval, minval, maxval;
} RecInt8;

typedef struct {
    int16_t val, defval, minval, maxval;
} RecInt16;

typedef struct {
    int32_t val, defval, minval, maxval;
} RecInt32;

typedef struct {
    int64_t val, defval, minval, maxval;
} RecInt64;

typedef struct {
    uint8_t val, defval, minval, maxval;
} RecUint8;

typedef struct {
    uint16_t val, defval, minval, maxval;
} RecUint16;

typedef struct {
    uint32_t val, defval, minval, maxval;
} RecUint32;

typedef struct {
    uint64_t val, defval, minval, maxval;
} RecUint64;

typedef struct {
    float val, defval, minval, maxval;
} RecFloat;

typedef struct {
    double val, defval, minval, maxval;
} RecDouble;

/*
 * Strings and domains stay in the application's memory: ulSize bytes at pData, which must live as
 * long as the entry refers to them, ulLength of them used.
 */
typedef struct {
    char *pData;
    unsigned long ulSize;
    unsigned long ulLength; /* without a NUL at the end */
} RecVisString;

typedef struct {
    unsigned char *pData;
    unsigned long ulSize;
    unsigned long ulLength;
} RecOctString;

typedef struct {
    void *pData;
    unsigned long ulSize;
    unsigned long ulLength;
} RecDomain;

typedef struct {
    unsigned long ulMs;    /* ms after midnight, 28 bits */
    unsigned short usDays; /* days since 1984-01-01 */
} CAN_TIME_OF_DAY;

typedef struct {
    unsigned long ulMs; /* 28 bits */
    unsigned short usDays;
} CAN_TIME_DIFFERENCE;

typedef struct {
    CAN_TIME_OF_DAY val, defval;
} RecTimeOfDay;

typedef struct {
    CAN_TIME_DIFFERENCE val, defval;
} RecTimeDifference;

/* The member for the type of the entry. */
typedef union {
    RecBool boolean;                  /* TYP_BOOL */
    RecInt8 int8;                     /* TYP_INT8, TYP_CHAR */
    RecInt16 int16;                   /* TYP_INT16 */
    RecInt32 int32;                   /* TYP_INT32 */
    RecInt64 int64;                   /* TYP_INT64, ours */
    RecUint8 uint8;                   /* TYP_UINT8 */
    RecUint16 uint16;                 /* TYP_UINT16 */
    RecUint32 uint32;                 /* TYP_UINT32 */
    RecUint64 uint64;                 /* TYP_UINT64, ours */
    RecFloat float32;                 /* TYP_FLOAT */
    RecDouble float64;                /* TYP_DOUBLE, ours */
    RecVisString visstring;           /* TYP_VIS_STRING */
    RecOctString octstring;           /* TYP_OCT_STRING */
    RecDomain domain;                 /* TYP_DOMAIN */
    RecTimeOfDay timeofday;           /* TYP_TIME_OF_DAY */
    RecTimeDifference timedifference; /* TYP_TIME_DIFFERENCE */
} DictionaryData, *pDictionaryData;

/*
 * Object handlers: told of data received for an entry, and asked for data of an entry.
 *
 *   Data == NULL  new data is wanted: a TPDO with this entry is due (SYNC, RTR, event timer);
 *                 write it with canOpenWriteDictionary(Hnd) and return SCANOPEN_OK
 *   else          data has come: a number of the entry's type, a RecVisString, RecOctString or
 *                 RecDomain, a CAN_TIME_OF_DAY or CAN_TIME_DIFFERENCE; valid during the call
 *       by PDO    it is in the dictionary already; the return value does not count
 *       by SDO    it is not there yet, the return value decides (within 1 s):
 *                 SCANOPEN_OK                takes it
 *                 a value above 0            refuses it with that abort code (CiA 301, 7.2.4.3.17)
 *                 SCANOPEN_VALUE_TOO_HIGH    refuses it with 06090031h
 *                 SCANOPEN_VALUE_TOO_LOW     refuses it with 06090032h
 *                 SCANOPEN_WRONG_PARAMETER   refuses it with 06090030h
 *                 anything else              refuses it with 08000020h
 *
 * The second form also gets the time of reception: ns of CLOCK_MONOTONIC, us with
 * NORMALIZE_TIMESTAMPS; the present time where data is wanted.
 */
typedef int (*PFN_COS_DATA_HANDLER)(int NetNo, int NodeNo, int Index, int Subindex, void *Data);
typedef int (*PFN_COS_DATA_HANDLER_TS)(int NetNo, int NodeNo, int Index, int Subindex, void *Data,
                                       uint64_t Timestamp);

/* PDOs ----------------------------------------------------------------------------------------- */

/* COB-ID: a CAN-ID or one of DEFAULT_PDO1..4 (CiA 301, 7.3.3: from the node-ID), and flags. */
#define DEFAULT_PDO1  1U
#define DEFAULT_PDO2  2U
#define DEFAULT_PDO3  3U
#define DEFAULT_PDO4  4U
#define DEFAULT_PDO_1 DEFAULT_PDO1
#define DEFAULT_PDO_2 DEFAULT_PDO2
#define DEFAULT_PDO_3 DEFAULT_PDO3
#define DEFAULT_PDO_4 DEFAULT_PDO4
#define PDO_VALID     0x00000000U /* the PDO exists when operational */
#define PDO_INVALID   0x80000000U /* not until a manager makes it valid */
#define RTR_ALLOW     0x00000000U /* transmit PDOs: may be requested by remote frame */
#define RTR_DISALLOW  0x40000000U

/*
 * Transfer mode: the transmission type of CiA 301 (7.5.2.35, 7.5.2.37), 0..255, and flags. One of
 * the first two is a must; the next two may be left out, the transmission type says the same.
 */
#define RECEIVE_PDO      0x0100
#define TRANSMIT_PDO     0x0200
#define SYNCHRON_PDO     0x0400
#define ASYNCHRON_PDO    0x0800
#define AUTO_NOTIFY_PDO  0x1000 /* asynchronous: new values send it, reception calls handlers */
#define AUTO_NOTIFY      AUTO_NOTIFY_PDO
#define TX_DONE_PDO      0x2000 /* sending waits until the frame was on the bus */
#define TIMER_DRIVEN_PDO 0x4000 /* transmit: the event timer asks the handlers for data */

/* emergency ------------------------------------------------------------------------------------ */

/* Error codes (CiA 301, 7.2.7.1), to be combined with 00h..FFh of the application. */
#define EMCY_ERROR_RESET              0x0000
#define EMCY_GENERIC_ERROR            0x1000
#define EMCY_CURRENT                  0x2000
#define EMCY_CURRENT_INPUT            0x2100
#define EMCY_CURRENT_INSIDE           0x2200
#define EMCY_CURRENT_OUTPUT           0x2300
#define EMCY_VOLTAGE                  0x3000
#define EMCY_VOLTAGE_INPUT            0x3100
#define EMCY_VOLTAGE_INSIDE           0x3200
#define EMCY_VOLTAGE_OUTPUT           0x3300
#define EMCY_TEMPERATURE              0x4000
#define EMCY_TEMPERATURE_AMBIENT      0x4100
#define EMCY_TEMPERATURE_DEVICE       0x4200
#define EMCY_DEVICE_HARDWARE          0x5000
#define EMCY_DEVICE_SOFTWARE          0x6000
#define EMCY_DEVICE_SOFTWARE_INTERNAL 0x6100
#define EMCY_DEVICE_SOFTWARE_USER     0x6200
#define EMCY_DEVICE_SOFTWARE_DATA_SET 0x6300
#define EMCY_ADDITIONAL_MODULES       0x7000
#define EMCY_MONITORING               0x8000
#define EMCY_MONITORING_COMMUNICATION 0x8100
#define EMCY_EXTERNAL_ERROR           0x9000
#define EMCY_ADDITIONAL_FUNCTIONS     0xF000
#define EMCY_DEVICE_SPECIFIC          0xFF00
/*
 * Sent by the library itself (names ours): the last bytes are EMCY_TEMPORARY_, EMCY_STICKY_, and
 *
 *   8100h  1: PDO daemon's queue, number lost (255: or more), 0    until the queue is empty
 *   8110h  0, 0, 0: received frames lost                           until 1 s has passed without
 *   8120h  0, 0, 0: CAN controller error passive                   until it is not
 *   8130h  0, 0, 0: life guarding or heartbeat                     until the next one comes
 *   8140h  0, 0, 0: the bus was lost, and is back                  until now
 *   8210h  number of the PDO, length received, length mapped       until a right one comes
 *   8220h  as 8210h                                                as 8210h
 *   8240h  0, length of SYNC received, expected                    until a right one comes
 *   8250h  number of the PDO, 0, 0                                 until the next one comes
 *
 * Then EMCY_ERROR_RESET is sent.
 */
#define EMCY_MESSAGE_LOST        0x8100
#define EMCY_CAN_OVERRUN         0x8110
#define EMCY_CAN_PASSIVE         0x8120
#define EMCY_ERROR_CONTROL       0x8130
#define EMCY_BUS_OFF_RECOVERED   0x8140
#define EMCY_PDO_NOT_PROCESSED   0x8210
#define EMCY_PDO_LENGTH_EXCEEDED 0x8220
#define EMCY_SYNC_LENGTH         0x8240
#define EMCY_RPDO_TIMEOUT        0x8250

/* First byte: errors that are present. Bits 5..7 are the application's. */
#define EMCY_TEMPORARY_ERROR_CONTROL 0x01
#define EMCY_TEMPORARY_CAN_PASSIVE   0x02
#define EMCY_TEMPORARY_BUS_OFF       0x04
/* Second byte: errors that have been. Bits 5..7 are the application's. */
#define EMCY_STICKY_CAN_ERROR    0x01
#define EMCY_STICKY_FIFO_OVERRUN 0x02
#define EMCY_STICKY_PDO_LENGTH   0x04

/* Bits of the error register, 1001h (CiA 301, 7.5.2.2). */
#define ERROR_GENERIC               0x01
#define ERROR_CURRENT               0x02
#define ERROR_VOLTAGE               0x04
#define ERROR_TEMPERATURE           0x08
#define ERROR_COMMUNICATION         0x10
#define ERROR_DEVICE_SPECIFIC       0x20
#define ERROR_MANUFACTURER_SPECIFIC 0x80

/* versions and parameters ---------------------------------------------------------------------- */

/* Versions of the parts: level in bits 12..15, revision in bits 8..11, change in bits 0..7. */
typedef struct {
    unsigned short cos;
    unsigned short sdm;
    unsigned short pdm;
    unsigned short nmt;
    unsigned short dbt;
    unsigned short cms;
    unsigned short sys;
    unsigned short can;
} CANOPEN_VERSIONS;

/* Commands of canOpenSetParameter and canOpenGetParameter, and what pArg points to. */
#define PARAM_DISABLE_AUTO_TRANSMISSION 1U /* NULL */
#define PARAM_ENABLE_AUTO_TRANSMISSION  2U /* NULL */
#define PARA_GET_TIMESTAMP_FREQUENCY    3U /* uint64_t: ticks per second, 1000000000 */
#define PARA_GET_TIMESTAMP              4U /* uint64_t: now, in these ticks */
#define PARAM_GET_TIMESTAMP_FREQUENCY   PARA_GET_TIMESTAMP_FREQUENCY
#define PARAM_GET_TIMESTAMP             PARA_GET_TIMESTAMP

#ifdef __cplusplus
}
#endif

#endif
