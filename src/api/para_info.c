#include "paraInfo.h"

/* n times the text of a number without message; C11 has no ranges in initializers. */
#define NONE_1   "unknown message",
#define NONE_2   NONE_1 NONE_1
#define NONE_4   NONE_2 NONE_2
#define NONE_8   NONE_4 NONE_4
#define NONE_16  NONE_8 NONE_8
#define NONE_32  NONE_16 NONE_16
#define NONE_64  NONE_32 NONE_32
#define NONE_128 NONE_64 NONE_64
#define NONE_256 NONE_128 NONE_128
#define NONE_248 NONE_128 NONE_64 NONE_32 NONE_16 NONE_8

const char *const cParaInfo[PARA_INFO_SIZE] = { NONE_1 "boot error", /* MCANOPEN_MSG_BOOT_ERROR */
                                                NONE_248 NONE_4 NONE_2 };

const char *const ucParaInfo[PARA_INFO_SIZE] = {
    NONE_1 "NMT state",                                     /* MCANOPEN_MSG_NODE_STATE */
    "boot-up message",                                      /* MCANOPEN_MSG_BOOT_UP */
    "started, state",                                       /* MCANOPEN_MSG_NODE_STARTED */
    "manager, state",                                       /* MCANOPEN_MSG_MANAGER_STATE */
    "network is up, booted nodes:",                         /* MCANOPEN_MSG_NETWORK_UP */
    "booted",                                               /* MCANOPEN_MSG_NODE_BOOTED */
    "boot step",                                            /* MCANOPEN_MSG_BOOT_STEP */
    "software update, step",                                /* MCANOPEN_MSG_SOFTWARE_UPDATE */
    "is missing, mandatory nodes missing in all:",          /* MCANOPEN_MSG_NODES_MISSING */
    "has failed, network halted, mandatory nodes missing:", /* ..._NETWORK_HALTED */
    "another NMT master commands",                          /* MCANOPEN_MSG_FOREIGN_COMMAND */
    "a tool commands by 1F82h",                             /* MCANOPEN_MSG_REQUESTED_COMMAND */
    "does not follow its start command, state",             /* MCANOPEN_MSG_NOT_STARTED */
    "another device has the node-ID of the manager, state", /* MCANOPEN_MSG_NODE_ID_TAKEN */
    "SYNC is not on the bus",                               /* MCANOPEN_MSG_SYNC_MISSING */
    "frames have to wait for the bus",                      /* MCANOPEN_MSG_BUS_BUSY */
    NONE_128 NONE_64 NONE_32 NONE_8 NONE_4 NONE_2 NONE_1
};

const char *const sParaInfo[PARA_INFO_SIZE] = { NONE_256 };

const char *const usParaInfo[PARA_INFO_SIZE] = {
    NONE_1 "heartbeat lost, consumer time in ms:",      /* MCANOPEN_MSG_HEARTBEAT_LOST */
    "heartbeat is back, consumer time in ms:",          /* MCANOPEN_MSG_HEARTBEAT_BACK */
    "mandatory nodes are missing, Boot_Time over, ms:", /* MCANOPEN_MSG_BOOT_TIME_OVER */
    "no answer to guarding, time in ms:",               /* MCANOPEN_MSG_GUARDING_LOST */
    "answers guarding again, time in ms:",              /* MCANOPEN_MSG_GUARDING_BACK */
    NONE_248 NONE_2
};

const char *const iParaInfo[PARA_INFO_SIZE] = {
    NONE_1 "CAN bus state",             /* MCANOPEN_MSG_BUS_STATE */
    NONE_32 "guarding toggle error no", /* MCANOPEN_MSG_GUARDING_TOGGLE */
    NONE_128 NONE_64 NONE_16 NONE_8 NONE_4 NONE_1
};

const char *const uiParaInfo[PARA_INFO_SIZE] = { NONE_256 };

const char *const lParaInfo[PARA_INFO_SIZE] = { NONE_256 };

const char *const ulParaInfo[PARA_INFO_SIZE] = {
    NONE_1 "emergency",                  /* MCANOPEN_MSG_EMERGENCY */
    "events lost, not fetched in time:", /* MCANOPEN_MSG_EVENTS_LOST */
    "CAN frames lost:",                  /* MCANOPEN_MSG_FRAMES_LOST */
    "CAN frames not sent in time:",      /* MCANOPEN_MSG_FRAMES_UNSENT */
    "configured, entries written:",      /* MCANOPEN_MSG_CONFIGURED */
    NONE_248 NONE_2
};

const char *const writeParaInfo[PARA_INFO_SIZE] = {
    NONE_1 "configuration aborted at", /* MCANOPEN_MSG_CONFIGURATION_ABORTED */
    "read during boot aborted at",     /* MCANOPEN_MSG_BOOT_READ_ABORTED */
    "software update aborted at",      /* MCANOPEN_MSG_SOFTWARE_UPDATE_ABORTED */
    "object written,",                 /* MCANOPEN_MSG_OBJECT_WRITTEN */
    NONE_248 NONE_2 NONE_1
};

const char *const strParaInfo[PARA_INFO_SIZE] = { NONE_1 "message:", /* MCANOPEN_MSG_TEXT */
                                                  NONE_248 NONE_4 NONE_2 };
