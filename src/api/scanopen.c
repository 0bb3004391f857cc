#include "scanopen.h"

/* In C11 a macro of the header, so that descriptors may be arrays of pointers. */
#undef canOpenExtendDictionary

/*
 * The slave functions, for as long as there are no local devices behind them: with no node there is
 * nothing that a handle could name.
 */

int canOpenCreateNetwork(int NetNo, const char *NetName, unsigned short Baudrate)
{
    (void)NetNo;
    (void)NetName;
    (void)Baudrate;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenCreateNetworkEx(int NetNo, const SLAVE_NET_INFO *pNetInfo)
{
    (void)NetNo;
    (void)pNetInfo;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenRemoveNetwork(int NetNo)
{
    (void)NetNo;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenCreateNodeEx(int iNetNo, int iModID, PFN_COS_EVENT_HANDLER EventHandler,
                        const SLAVE_NODE_INFO *pSlaveInfo, HNODE *HNode)
{
    (void)iNetNo;
    (void)iModID;
    (void)EventHandler;
    (void)pSlaveInfo;
    (void)HNode;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenCreateNode(int NetNo, const char *NodeName, int ModID, unsigned long DevType,
                      int Options, int MaxErrors, const char *DeviceName, const char *HardwareVers,
                      const char *SoftwareVers, unsigned short GuardTime, unsigned short LifeTime,
                      unsigned short ServerObjects, unsigned short ClientObjects,
                      PFN_COS_EVENT_HANDLER_OLD EventHandler, HNODE *HNode)
{
    (void)NetNo;
    (void)NodeName;
    (void)ModID;
    (void)DevType;
    (void)Options;
    (void)MaxErrors;
    (void)DeviceName;
    (void)HardwareVers;
    (void)SoftwareVers;
    (void)GuardTime;
    (void)LifeTime;
    (void)ServerObjects;
    (void)ClientObjects;
    (void)EventHandler;
    (void)HNode;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenDeleteNode(HNODE HNode)
{
    (void)HNode;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenActivateNode(HNODE HNode)
{
    (void)HNode;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenGetNodeInfo(HNODE HNode, int *State, int *LastErr)
{
    (void)HNode;
    (void)State;
    (void)LastErr;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenResetNode(HNODE HNode)
{
    (void)HNode;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenWaitForNodeState(HNODE HNode, unsigned short StateMask)
{
    (void)HNode;
    (void)StateMask;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenExtendDictionary(HNODE HNode, unsigned short Index, unsigned short Subentries,
                            unsigned short ObjectType, const char *DataType)
{
    (void)HNode;
    (void)Index;
    (void)Subentries;
    (void)ObjectType;
    (void)DataType;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenInitDictionary(HNODE HNode, unsigned short Index, unsigned short Subindex,
                          const char *EntryName, unsigned short Flags, pDictionaryData Data,
                          PFN_COS_DATA_HANDLER Handler)
{
    (void)HNode;
    (void)Index;
    (void)Subindex;
    (void)EntryName;
    (void)Flags;
    (void)Data;
    (void)Handler;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenInitDictionaryTs(HNODE HNode, unsigned short Index, unsigned short Subindex,
                            const char *EntryName, unsigned short Flags, pDictionaryData Data,
                            PFN_COS_DATA_HANDLER_TS Handler)
{
    (void)HNode;
    (void)Index;
    (void)Subindex;
    (void)EntryName;
    (void)Flags;
    (void)Data;
    (void)Handler;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenInitDictionaryTS(HNODE HNode, unsigned short Index, unsigned short Subindex,
                            const char *EntryName, unsigned short Flags, pDictionaryData Data,
                            PFN_COS_DATA_HANDLER_TS Handler)
{
    (void)HNode;
    (void)Index;
    (void)Subindex;
    (void)EntryName;
    (void)Flags;
    (void)Data;
    (void)Handler;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenReadDictionary(HNODE HNode, unsigned short Index, unsigned short Subindex, void *Data)
{
    (void)HNode;
    (void)Index;
    (void)Subindex;
    (void)Data;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenWriteDictionary(HNODE HNode, unsigned short Index, unsigned short Subindex,
                           const void *Data)
{
    (void)HNode;
    (void)Index;
    (void)Subindex;
    (void)Data;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenGetDictionaryHnd(HNODE HNode, unsigned short Index, unsigned short Subindex,
                            HDICT *HDict)
{
    (void)HNode;
    (void)Index;
    (void)Subindex;
    if (HDict)
        *HDict = NULL;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenReadDictionaryHnd(HDICT HDict, void *Data)
{
    (void)HDict;
    (void)Data;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenWriteDictionaryHnd(HDICT HDict, const void *Data)
{
    (void)HDict;
    (void)Data;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenDefinePDO(HNODE HNode, const char *Name, uint32_t COBid, uint16_t TransMode,
                     int32_t InhibitTime, uint16_t TxTout, uint16_t RxTout, int32_t iEventTimer,
                     const uint16_t *Mapping, HPDO *Hpdo)
{
    (void)HNode;
    (void)Name;
    (void)COBid;
    (void)TransMode;
    (void)InhibitTime;
    (void)TxTout;
    (void)RxTout;
    (void)iEventTimer;
    (void)Mapping;
    (void)Hpdo;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenWritePDO(HPDO Hpdo, const void *buffer)
{
    (void)Hpdo;
    (void)buffer;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenReadPDO(HPDO Hpdo, void *buffer)
{
    (void)Hpdo;
    (void)buffer;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenRequestPDO(HPDO Hpdo, void *buffer)
{
    (void)Hpdo;
    (void)buffer;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenSetError(HNODE Hnode, unsigned short ErrorCode, unsigned short ErrorInformation,
                    unsigned short ErrorRegister, const unsigned char *ErrorField)
{
    (void)Hnode;
    (void)ErrorCode;
    (void)ErrorInformation;
    (void)ErrorRegister;
    (void)ErrorField;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenResetError(HNODE Hnode, unsigned short ErrorRegister, const unsigned char *ErrorField)
{
    (void)Hnode;
    (void)ErrorRegister;
    (void)ErrorField;
    return SCANOPEN_NOT_IMPLEMENTED;
}

void canOpenGetVersions(CANOPEN_VERSIONS *versions)
{
    const unsigned short own = (unsigned short)(MCANOPEN_VERSION_MAJOR << 12 |
                                                MCANOPEN_VERSION_MINOR << 8 |
                                                MCANOPEN_VERSION_PATCH);

    if (versions)
        *versions = (CANOPEN_VERSIONS){ own, own, own, own, own, own, own, own };
}

int canOpenSetParameter(HNODE hNode, uint32_t uiCommand, void *pArg)
{
    (void)hNode;
    (void)uiCommand;
    (void)pArg;
    return SCANOPEN_NOT_IMPLEMENTED;
}

int canOpenGetParameter(HNODE hNode, uint32_t uiCommand, void *pArg)
{
    (void)hNode;
    (void)uiCommand;
    (void)pArg;
    return SCANOPEN_NOT_IMPLEMENTED;
}
