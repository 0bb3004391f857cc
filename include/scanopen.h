/*
 * scanopen: CANopen slaves (CiA 301) in this process, each with an object dictionary of its own, on
 * one or more CAN networks. mcanopen.h is the manager of the same library; both may share a
 * network.
 *
 *   canOpenCreateNetworkEx(0, &network);
 *   canOpenCreateNodeEx(0, 5, on_event, &info, &node);
 *   DECLARE_DICTIONARY(node, Objects);          the tables of scanopen_tables.h, or
 *   DECLARE_PDO(node, Pdos);                    canOpenExtendDictionary, InitDictionary, DefinePDO
 *   canOpenActivateNode(node);
 *
 * Return values: SCANOPEN_OK or one of the error codes of scanopen_types.h. Any function with a
 * handle returns SCANOPEN_INVALID_HANDLE for a handle that is NULL, was never given out or belongs
 * to something that has been deleted, and SCANOPEN_WRONG_PARAMETER for a NULL pointer or a number
 * out of range; below only what goes beyond that is told.
 *
 * Threads: every function may be called from any thread. From a callback (object handlers, event
 * handlers, the log hook of mcanopen.h) all may be called but those marked "not from callbacks",
 * which return SCANOPEN_SERVICE_NOT_ALLOWED there at once. Handlers run in threads of the library,
 * one after the other for each kind of service, and never while the library holds a lock; a slow
 * handler delays other handlers, but not the protocol. After fork() the child may use no function
 * of the library.
 *
 * "Ours" marks what goes beyond the interface of the manual. Where the manual spells a name in two
 * ways, both are there. Pointers to data that the library only reads are const here, where the
 * manual prints them without.
 */
#ifndef SCANOPEN_H
#define SCANOPEN_H

#include "scanopen_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* networks ------------------------------------------------------------------------------------- */

/*
 * Opens network NetNo (0..255: interface can<NetNo>, or what the environment says,
 * MCANOPEN_NET_0=vcan0) and starts its threads. The bit rate of a real interface is set by the
 * system; here it is compared. A network that the manager has open is shared: its bit rate must be
 * equal, its priorities hold. canOpenCreateNetwork is the older form, without options. Not from
 * callbacks.
 *
 *   SCANOPEN_WRONG_BAUDRATE       not of CANopen, or the interface or the manager has another
 *   SCANOPEN_WRONG_PARAMETER      also: the network exists already, unknown option, priority out of
 *                                 range
 *   SCANOPEN_INIT_ERRORS          the interface is missing, down or forbidden
 *   SCANOPEN_CANNOT_START_DAEMON  no thread
 *   SCANOPEN_OUT_OF_MEMORY
 */
MCANOPEN_API int canOpenCreateNetwork(int NetNo, const char *NetName, unsigned short Baudrate);
MCANOPEN_API int canOpenCreateNetworkEx(int NetNo, const SLAVE_NET_INFO *pNetInfo);

/*
 * Gives network NetNo back; a manager on it goes on. Not from callbacks.
 *
 *   SCANOPEN_SERVICE_NOT_ALLOWED  nodes are left on it: delete them first
 *   SCANOPEN_WRONG_PARAMETER      the network is not created
 */
MCANOPEN_API int canOpenRemoveNetwork(int NetNo);

/* nodes ---------------------------------------------------------------------------------------- */

/*
 * Makes a node with node-ID iModID (1..127) and the objects of its communication profile, state
 * NodeOffline. EventHandler may be NULL. *HNode gets the handle. Not from callbacks.
 *
 *   SCANOPEN_WRONG_PARAMETER      also: the network is not created, the node-ID is in use there (by
 *                                 another local node or the manager), a member of *pSlaveInfo is
 *                                 out of its range or does not fit the options
 *   SCANOPEN_TOO_MANY_OBJECTS     255 nodes exist
 *   SCANOPEN_OUT_OF_MEMORY, SCANOPEN_CANNOT_START_DAEMON, SCANOPEN_INIT_ERRORS
 */
MCANOPEN_API int canOpenCreateNodeEx(int iNetNo, int iModID, PFN_COS_EVENT_HANDLER EventHandler,
                                     const SLAVE_NODE_INFO *pSlaveInfo, HNODE *HNode);

/*
 * Ours: a node with all objects and PDOs of its EDS or DCF file (CiA 306), with the DefaultValues.
 * Entries of the objects 2000h..9FFFh may be given handlers by canOpenInitDictionary; what the
 * application writes to a mapped entry is sent, as with AUTO_NOTIFY. All SDO servers that the file
 * has (1201h..127Fh) are served, and block transfers. Of *pSlaveInfo, which may be NULL, only
 * ulEventMask, usPdoRxQueueSize and, of ulOptions, PDO_ACCEPT_LONG are looked at. What is
 * wrong in the file goes to the log (mcanOpenSetLog). Errors as above, and
 *
 *   SCANOPEN_WRONG_PARAMETER  also: the file cannot be read, or is no EDS or DCF file
 */
MCANOPEN_API int canOpenCreateNodeFromFile(int iNetNo, int iModID,
                                           PFN_COS_EVENT_HANDLER EventHandler, const char *FileName,
                                           const SLAVE_NODE_INFO *pSlaveInfo, HNODE *HNode);

/*
 * The older form, for existing programs: fewer objects and events. GuardTime in ms; NodeName is for
 * messages, ServerObjects and ClientObjects as ucServerSDO and ucClientSDO. Errors as above.
 */
MCANOPEN_API int canOpenCreateNode(int NetNo, const char *NodeName, int ModID,
                                   unsigned long DevType, int Options, int MaxErrors,
                                   const char *DeviceName, const char *HardwareVers,
                                   const char *SoftwareVers, unsigned short GuardTime,
                                   unsigned short LifeTime, unsigned short ServerObjects,
                                   unsigned short ClientObjects,
                                   PFN_COS_EVENT_HANDLER_OLD EventHandler, HNODE *HNode);

/*
 * Deletes a node that is in NodeOffline (canOpenResetNode brings it there); its handle and those of
 * its PDOs and entries end, and calls waiting on it return SCANOPEN_INVALID_HANDLE. Not from
 * callbacks.
 *
 *   SCANOPEN_WRONG_NODESTATE  not in NodeOffline
 */
MCANOPEN_API int canOpenDeleteNode(HNODE HNode);

/*
 * Puts a node in NodeOffline on the bus: boot-up message, then pre-operational, with AUTO_START
 * operational (CiA 301, 7.3.2). From then on NMT, SDO and error control are served, and PDOs when
 * operational. Not from callbacks.
 *
 *   SCANOPEN_WRONG_NODESTATE  not in NodeOffline
 *   SCANOPEN_OUT_OF_MEMORY, SCANOPEN_CANNOT_START_DAEMON
 */
MCANOPEN_API int canOpenActivateNode(HNODE HNode);

/* The state, NodeInit .. NodePreOperational, and the code of the last EMCY, 0: none. */
MCANOPEN_API int canOpenGetNodeInfo(HNODE HNode, int *State, int *LastErr);

/*
 * Takes a node from the bus, to NodeOffline, and brings back the power-on values of its objects;
 * what clients have begun is aborted. The dictionary may then be extended again. Not from
 * callbacks.
 */
MCANOPEN_API int canOpenResetNode(HNODE HNode);

/*
 * Waits until the node is in one of the states of StateMask, WFNS_... combined, and returns that
 * state (NodeInit .. NodePreOperational) or an error code. There is no time limit. Not from
 * callbacks.
 *
 *   SCANOPEN_INVALID_HANDLE  also: the node was deleted while waiting
 */
MCANOPEN_API int canOpenWaitForNodeState(HNODE HNode, unsigned short StateMask);

/* object dictionary ---------------------------------------------------------------------------- */

/*
 * Adds object Index (2000h..9FFFh) to a node in NodeOffline (CiA 301, 7.4). Subentries (0..254) is
 * the highest sub-index; DataType a descriptor, the types as chars and a 0:
 *
 *   OBJ_VAR     Subentries 0, one type
 *   OBJ_ARRAY   one type, for the sub-indices 1..Subentries; sub-index 0 is made by the library
 *   OBJ_RECORD  Subentries + 1 types, for 0..Subentries, the first TYP_UINT8; or Subentries types,
 *               then the record has no sub-index 0 (as old devices had it)
 *
 * Sub-index FFh is made by the library. In C11 a descriptor may also be an array of pointers, as
 * the manual prints it, see below.
 *
 *   SCANOPEN_WRONG_INDEX        not 2000h..9FFFh, or the object exists
 *   SCANOPEN_WRONG_SUBINDEX     Subentries is out of range or not 0 for OBJ_VAR
 *   SCANOPEN_WRONG_OBJECT_TYPE
 *   SCANOPEN_WRONG_TYPE         unknown type, or another number of types than told above
 *   SCANOPEN_WRONG_NODESTATE    not in NodeOffline
 *   SCANOPEN_OUT_OF_MEMORY
 */
MCANOPEN_API int canOpenExtendDictionary(HNODE HNode, unsigned short Index,
                                         unsigned short Subentries, unsigned short ObjectType,
                                         const char *DataType);

/*
 * Gives an entry of canOpenExtendDictionary its properties (READ_ACCESS ...), its value in *Data
 * (the member for its type), and its handler, which may be NULL. EntryName may be NULL. *Data is
 * copied but for the memory of strings and domains. May be repeated: the last call holds.
 *
 *   SCANOPEN_WRONG_INDEX, SCANOPEN_WRONG_SUBINDEX   no such entry
 *   SCANOPEN_VALUE_TOO_HIGH, SCANOPEN_VALUE_TOO_LOW the value is not within its own limits
 *   SCANOPEN_WRONG_PARAMETER                        also: unknown flags, minimum above maximum, a
 *                                                   string longer than its memory
 *   SCANOPEN_WRONG_NODESTATE                        not in NodeOffline
 */
MCANOPEN_API int canOpenInitDictionary(HNODE HNode, unsigned short Index, unsigned short Subindex,
                                       const char *EntryName, unsigned short Flags,
                                       pDictionaryData Data, PFN_COS_DATA_HANDLER Handler);

/* The same for handlers that want the time of reception. */
MCANOPEN_API int canOpenInitDictionaryTs(HNODE HNode, unsigned short Index, unsigned short Subindex,
                                         const char *EntryName, unsigned short Flags,
                                         pDictionaryData Data, PFN_COS_DATA_HANDLER_TS Handler);
MCANOPEN_API int canOpenInitDictionaryTS(HNODE HNode, unsigned short Index, unsigned short Subindex,
                                         const char *EntryName, unsigned short Flags,
                                         pDictionaryData Data, PFN_COS_DATA_HANDLER_TS Handler);

/*
 * Ours: the bytes of a domain are in a file, MaxSize of them at most (1..2^31-1), until the next
 * canOpenInitDictionary for the entry. A client that reads gets what is in the file at that moment,
 * and one that writes replaces it, at once and so that a power cut leaves the old file or the new
 * one; what is written meanwhile is in FileName~ beside it. The entry's handler is asked first, with
 * the bytes received. The file need not be there yet, its folder must. FileName is copied; a
 * relative one is looked up in the process's current folder when a client comes.
 *
 * The file work is done in the SDO daemon, and has to be over within 1 s, as a handler. A client
 * gets 08000024h where there is no file, 06070012h for one, or for data, longer than MaxSize, and
 * 06060000h for other errors. To the application the entry has no value: canOpenReadDictionary and
 * canOpenWriteDictionary return SCANOPEN_WRONG_TYPE. It is not part of what 1010h stores.
 *
 *   SCANOPEN_WRONG_INDEX, SCANOPEN_WRONG_SUBINDEX  no such entry of 2000h..9FFFh
 *   SCANOPEN_WRONG_TYPE                            no domain, or never initialized
 *   SCANOPEN_WRONG_PARAMETER                       also: no FileName, MaxSize out of range
 *   SCANOPEN_WRONG_NODESTATE                       not in NodeOffline
 *   SCANOPEN_OUT_OF_MEMORY
 */
MCANOPEN_API int canOpenSetDomainFile(HNODE HNode, unsigned short Index, unsigned short Subindex,
                                      const char *FileName, unsigned long MaxSize);

/*
 * Reads an entry of the node's own dictionary, in any state. Data points to the number, in the size
 * of its type (4 bytes for INTEGER24, 8 for those of 40 to 56 bits), or else to a pointer: to the
 * first byte of a string or domain, or to the CAN_TIME_OF_DAY or CAN_TIME_DIFFERENCE. What the
 * pointer names is valid until the entry is next written or deleted. Behind a string that clients
 * may write there is a NUL where its memory has room for it. Entries without any right for SDO
 * clients can be read, those that clients can only write cannot.
 *
 *   SCANOPEN_WRONG_INDEX, SCANOPEN_WRONG_SUBINDEX  no such entry
 *   SCANOPEN_WRONG_TYPE                            the entry was never initialized, or is in a file
 *   SCANOPEN_ACCESS_ERROR                          the entry can only be written
 */
MCANOPEN_API int canOpenReadDictionary(HNODE HNode, unsigned short Index, unsigned short Subindex,
                                       void *Data);

/*
 * Writes an entry of the node's own dictionary, in any state. Data points to
 *
 *   BOOL, CHAR, INTn, UINTn, FLOAT, DOUBLE   the number, in the size of its type; copied
 *   TIME_OF_DAY, TIME_DIFFERENCE             the structure; copied
 *   VIS_STRING, OCT_STRING, DOMAIN           RecVisString, RecOctString, RecDomain; the memory it
 *                                            names is referred to and must stay
 *
 * PDOs with the entry change with it; an asynchronous one with AUTO_NOTIFY is sent when the node is
 * operational. Data NULL sends it without a change.
 *
 *   SCANOPEN_WRONG_INDEX, SCANOPEN_WRONG_SUBINDEX    no such entry
 *   SCANOPEN_VALUE_TOO_HIGH, SCANOPEN_VALUE_TOO_LOW  outside the limits; nothing changed
 *   SCANOPEN_WRONG_PARAMETER                         also: NULL for an entry in no such PDO, a
 *                                                    string longer than its memory
 *   SCANOPEN_WRONG_TYPE                              the entry was never initialized, or is in a
 *                                                    file
 *   SCANOPEN_ACCESS_ERROR                            the entry is constant, or the library's own
 *   SCANOPEN_INHIBITED                               a warning: stored; the PDO goes out once, with
 *                                                    the latest data, when its inhibit time ends
 *   SCANOPEN_WRONG_NODESTATE                         a warning, Data NULL only: not operational
 *   SCANOPEN_TX_TIMEOUT                              stored, but the PDO could not be sent in time
 */
MCANOPEN_API int canOpenWriteDictionary(HNODE HNode, unsigned short Index, unsigned short Subindex,
                                        const void *Data);

/*
 * A handle for an entry, which saves the search in the calls that follow. *HDict is NULL on an
 * error. The handle ends with the node.
 *
 *   SCANOPEN_WRONG_INDEX, SCANOPEN_WRONG_SUBINDEX  no such entry
 */
MCANOPEN_API int canOpenGetDictionaryHnd(HNODE HNode, unsigned short Index, unsigned short Subindex,
                                         HDICT *HDict);

/* As canOpenReadDictionary and canOpenWriteDictionary, with a handle. */
MCANOPEN_API int canOpenReadDictionaryHnd(HDICT HDict, void *Data);
MCANOPEN_API int canOpenWriteDictionaryHnd(HDICT HDict, const void *Data);

/*
 * Ours: the power-on values of a node in NodeOffline are kept in a file, by clients' "save" (1010h)
 * and "load" (1011h). Call it when the dictionary is complete, before canOpenActivateNode: values
 * that the file has become power-on values and present ones. NULL: none any more.
 *
 * In the file is a concise DCF (CiA 302-3, 1F22h; ccfread shows it) of all parameters, entries that
 * clients can write and that are no domains, whose power-on value is not the one that the
 * application or the EDS has given. Values that no longer fit, and a file that cannot be read, are
 * told (mcanOpenSetLog), and there the node has its default values; a file that is not there is
 * none yet.
 *
 * It is written before the client is answered, and replaced as a whole, by way of FileName~:
 * whenever the power fails the old values or the new ones are there. A "load" waits for the reset,
 * but a node that is started anew has the default values at once. When the file cannot be written
 * the client gets 06060000h, and neither file nor node change. Not from callbacks.
 *
 *   SCANOPEN_WRONG_PARAMETER      FileName is empty
 *   SCANOPEN_WRONG_NODESTATE      not in NodeOffline
 *   SCANOPEN_SERVICE_NOT_ALLOWED  also: the node has no 1010h
 *   SCANOPEN_OUT_OF_MEMORY, SCANOPEN_CANNOT_START_DAEMON
 */
MCANOPEN_API int canOpenSetStoreFile(HNODE HNode, const char *FileName);

/* PDOs ----------------------------------------------------------------------------------------- */

/*
 * Gives a node in NodeOffline one more PDO (CiA 301, 7.2.2): the n-th call for a received PDO makes
 * 1400h + n - 1 and 1600h + n - 1, for a transmitted one 1800h and 1A00h. *Hpdo gets the handle.
 *
 *   Name         not used, NULL
 *   COBid        CAN-ID or DEFAULT_PDO1..4; PDO_VALID or PDO_INVALID; RTR_ALLOW or RTR_DISALLOW
 *   TransMode    transmission type 0..255 with RECEIVE_PDO or TRANSMIT_PDO and further flags
 *   InhibitTime  least time between two frames, 0..6553 ms, 0: none
 *   TxTout       how long a frame may wait to be sent, ms; 0: until the network gives it up, 2 s after
 *                the bus has ceased to take frames
 *   RxTout       how long canOpenReadPDO and canOpenRequestPDO wait, ms; 0: they do not
 *   iEventTimer  asynchronous transmit PDOs: sent at the latest after 1..65535 ms, 0: off
 *   Mapping      pairs of index and sub-index, at the end 0, 0; index 1..7, sub-index 0: a dummy of
 *                that data type; NULL: nothing is mapped
 *
 *   SCANOPEN_TOO_MANY_OBJECTS     more than usRxPDO or usTxPDO, or an entry is in too many PDOs
 *   SCANOPEN_PDO_MAPPING_ERROR    no such entry, not mappable, wrong access rights for the
 *                                 direction, in another PDO without MULTI_MAP, more than 64 bits
 *   SCANOPEN_PDO_PARAMETER_ERROR  COBid, TransMode or a time is not valid
 *   SCANOPEN_WRONG_NODESTATE      not in NodeOffline
 *   SCANOPEN_OUT_OF_MEMORY
 */
MCANOPEN_API int canOpenDefinePDO(HNODE HNode, const char *Name, uint32_t COBid, uint16_t TransMode,
                                  int32_t InhibitTime, uint16_t TxTout, uint16_t RxTout,
                                  int32_t iEventTimer, const uint16_t *Mapping, HPDO *Hpdo);

/*
 * Ours: the handle of the PDO with the communication parameter Index, 1400h..15FFh or 1800h..19FFh;
 * of a node from a file, too. *Hpdo is NULL on an error.
 *
 *   SCANOPEN_WRONG_INDEX  there is no such PDO
 */
MCANOPEN_API int canOpenGetPDOHnd(HNODE HNode, unsigned short Index, HPDO *Hpdo);

/*
 * Sends an asynchronous transmit PDO: as it is, or, with buffer, the bytes at buffer (as many as
 * are mapped), which also go into the mapped entries. Waits up to TxTout only with TX_DONE_PDO, and
 * then not from callbacks.
 *
 *   SCANOPEN_WRONG_NODESTATE      not operational
 *   SCANOPEN_SERVICE_NOT_ALLOWED  no asynchronous transmit PDO, or it is invalid
 *   SCANOPEN_VALUE_TOO_HIGH, SCANOPEN_VALUE_TOO_LOW  an entry's limits; nothing is stored or sent
 *   SCANOPEN_INHIBITED            a warning: stored, goes out once when the inhibit time ends
 *   SCANOPEN_TX_TIMEOUT           not sent in time
 */
MCANOPEN_API int canOpenWritePDO(HPDO Hpdo, const void *buffer);

/*
 * Waits up to RxTout for the next reception of a PDO. With buffer (8 bytes or more) its data goes
 * there and the object handlers are not called for it; with NULL they are called. Not from
 * callbacks.
 *
 *   SCANOPEN_RX_TIMEOUT           nothing came
 *   SCANOPEN_WRONG_NODESTATE      not operational, or no longer
 *   SCANOPEN_SERVICE_NOT_ALLOWED  not a received PDO, or it is invalid
 *   SCANOPEN_LENGTH_MISMATCH      it came with another length than its mapping
 *   SCANOPEN_INVALID_HANDLE       also: the node was deleted meanwhile
 */
MCANOPEN_API int canOpenReadPDO(HPDO Hpdo, void *buffer);

/*
 * Requests a PDO by remote frame (CiA 301, 7.2.2) and waits for it as canOpenReadPDO does. Not from
 * callbacks. Errors as there, and
 *
 *   SCANOPEN_SERVICE_NOT_ALLOWED  also: the PDO has RTR_DISALLOW
 *   SCANOPEN_TX_TIMEOUT           the request was not sent in time
 */
MCANOPEN_API int canOpenRequestPDO(HPDO Hpdo, void *buffer);

/* emergency ------------------------------------------------------------------------------------ */

/*
 * Reports an error of the application (CiA 301, 7.2.7): counts it, sets the bits ErrorRegister
 * (ERROR_...) in 1001h, where ERROR_GENERIC is set as long as there is any error, puts ErrorCode
 * (EMCY_..., with the application's own lower byte) and ErrorInformation on top of 1003h where that
 * is there, and sends the EMCY object with ErrorCode, 1001h and the 5 bytes at ErrorField; NULL:
 * zeros. In NodeStopped, while the bus is lost and within the inhibit time the object is kept back
 * until it may be sent; with more than 16 the oldest 15 and the latest one stay, and the log tells
 * how many do not. A reset by NMT ends all errors.
 *
 * Bits 5..7 of the first two bytes at ErrorField are also set in the EMCY objects that the library
 * sends itself from now on: those of the first one (EMCY_TEMPORARY_...) as long as
 * canOpenResetError says, those of the second one (EMCY_STICKY_...) until the next reset by NMT.
 *
 *   SCANOPEN_WRONG_PARAMETER  ErrorCode is 0000h, ErrorRegister has bit 6 or is above FFh
 *   SCANOPEN_WRONG_NODESTATE  in NodeOffline
 */
MCANOPEN_API int canOpenSetError(HNODE Hnode, unsigned short ErrorCode,
                                 unsigned short ErrorInformation, unsigned short ErrorRegister,
                                 const unsigned char *ErrorField);

/*
 * Takes one error of the application back: counts it off, clears the bits ErrorRegister in 1001h and
 * sends the EMCY object with error code 0000h and the 5 bytes at ErrorField. With the last error of
 * the application its bits have gone, and with the last error of all 1001h is 0. ErrorField says how
 * things are now: of the application's bits of its first byte those stay that are set here.
 *
 *   SCANOPEN_WRONG_PARAMETER  ErrorRegister has bit 6 or is above FFh
 *   SCANOPEN_WRONG_NODESTATE  in NodeOffline, or the application has no error
 */
MCANOPEN_API int canOpenResetError(HNODE Hnode, unsigned short ErrorRegister,
                                   const unsigned char *ErrorField);

/* time ----------------------------------------------------------------------------------------- */

/*
 * Ours: sends TIME (CiA 301, 7.2.6) on the CAN-ID of 1012h: *Time, or with NULL the system's clock
 * in UTC.
 *
 *   SCANOPEN_WRONG_PARAMETER      ulMs is above 86399999
 *   SCANOPEN_WRONG_NODESTATE      neither pre-operational nor operational
 *   SCANOPEN_SERVICE_NOT_ALLOWED  the node has no 1012h, or that does not make it a producer (bit
 *                                 30)
 */
MCANOPEN_API int canOpenSendTime(HNODE HNode, const CAN_TIME_OF_DAY *Time);

/* versions and parameters ---------------------------------------------------------------------- */

/* The versions of the parts of this library, which are all the same. versions may be NULL. */
MCANOPEN_API void canOpenGetVersions(CANOPEN_VERSIONS *versions);

/*
 * PARAM_DISABLE_AUTO_TRANSMISSION lets canOpenWriteDictionary(Hnd) change entries of PDOs with
 * AUTO_NOTIFY without sending them, PARAM_ENABLE_AUTO_TRANSMISSION ends that and sends each PDO
 * that has changed meanwhile once. pArg is NULL.
 *
 *   SCANOPEN_WRONG_PARAMETER  unknown uiCommand, or pArg is not NULL
 */
MCANOPEN_API int canOpenSetParameter(HNODE hNode, uint32_t uiCommand, void *pArg);

/*
 * PARA_GET_TIMESTAMP, PARA_GET_TIMESTAMP_FREQUENCY: the clock that object handlers get, and its
 * ticks per second. pArg points to a uint64_t. NORMALIZE_TIMESTAMPS has no influence.
 *
 *   SCANOPEN_WRONG_PARAMETER  unknown uiCommand, or pArg is NULL
 */
MCANOPEN_API int canOpenGetParameter(HNODE hNode, uint32_t uiCommand, void *pArg);

#ifdef __cplusplus
}
#endif

#include "scanopen_tables.h"

#endif
