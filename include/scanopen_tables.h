/*
 * Tables of dictionary entries, mappings and PDOs; part of scanopen.h, do not include it yourself.
 *
 *   BEGIN_DICTIONARY_TABLE(Objects)
 *       DICTIONARY_ENTRY(0x6200, 2, OBJ_ARRAY, MAP_UINT8, READ_ACCESS | WRITE_ACCESS | MAPPABLE,
 *                        &initial, on_output, NULL)
 *   END_DICTIONARY_TABLE()
 *
 *   BEGIN_MAPPING_TABLE(Outputs)
 *       MAPPING_ENTRY(0x6200, 1)
 *       MAPPING_ENTRY(0x6200, 2)
 *   END_MAPPING_TABLE()
 *
 *   BEGIN_PDO_TABLE(Pdos)
 *       PDO_ENTRY(DEFAULT_PDO1, RECEIVE_PDO | ASYNCHRON_PDO | AUTO_NOTIFY | 255, 0, 0, 0, 0,
 *                 Outputs)
 *   END_PDO_TABLE()
 *
 *   result = DECLARE_DICTIONARY(node, Objects);
 *   result = DECLARE_PDO(node, Pdos);
 *
 * Tables stand at file or at function scope, without semicolons. The two DECLARE macros are
 * expressions: they make the calls of scanopen.h for the entries in order, up to the first that
 * fails, and give its error, or SCANOPEN_OK. They are used between canOpenCreateNodeEx and
 * canOpenActivateNode, mixed with calls as needed: canOpenInitDictionary afterwards gives single
 * sub-indices other properties.
 */
#ifndef SCANOPEN_TABLES_H
#define SCANOPEN_TABLES_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    unsigned short Index;
    unsigned short Subindex; /* the highest */
    unsigned short ObjectType;
    const char *DataType;
    unsigned short Flags;
    pDictionaryData Data;
    PFN_COS_DATA_HANDLER Handler;
    const char *EntryName;
} _COS_DICT_ENTRY;

typedef struct {
    unsigned short Index;
    unsigned short Subindex;
    unsigned short ObjectType;
    const char *DataType;
    unsigned short Flags;
    pDictionaryData Data;
    PFN_COS_DATA_HANDLER_TS Handler;
    const char *EntryName;
} _COS_DICT_ENTRY_TS;

typedef struct {
    uint32_t COBid;
    uint16_t TransMode;
    int32_t InhibitTime;
    uint16_t TxTout;
    uint16_t RxTout;
    int32_t EventTimer;
    const uint16_t *Mapping;
    HPDO handle; /* set by DECLARE_PDO: _PDO_Table_Pdos[0].handle is that of the first PDO */
} _COS_PDO_ENTRY;

/* clang-format off */

/*
 * Objects with or without a time in their handlers. A record gets sub-index 0 by itself; its
 * DataType has one type for all sub-indices, or one for each.
 */
#define BEGIN_DICTIONARY_TABLE(DictionaryName) \
    enum { _Dict_Kind_##DictionaryName = 0 }; \
    static const _COS_DICT_ENTRY _Dict_Entry_##DictionaryName[] MCANOPEN_MAYBE_UNUSED = {

#define BEGIN_DICTIONARY_TABLE_TS(DictionaryName) \
    enum { _Dict_Kind_##DictionaryName = 1 }; \
    static const _COS_DICT_ENTRY_TS _Dict_Entry_##DictionaryName[] MCANOPEN_MAYBE_UNUSED = {

#define DICTIONARY_ENTRY(Index, Subindex, ObjectType, DataType, Flags, Data, Handler, EntryName) \
        { (Index), (Subindex), (ObjectType), (DataType), (Flags), (Data), (Handler), (EntryName) },

#define END_DICTIONARY_TABLE() \
        { 0, 0, 0, NULL, 0, NULL, NULL, NULL } \
    };

#define END_DICTIONARY_TABLE_TS() END_DICTIONARY_TABLE()

#define BEGIN_MAPPING_TABLE(MappingName) \
    static const unsigned short _Mapping_##MappingName[] MCANOPEN_MAYBE_UNUSED = {

#define MAPPING_ENTRY(Index, Subindex) (Index), (Subindex),

#define END_MAPPING_TABLE() \
        0, 0 \
    };

#define BEGIN_PDO_TABLE(PDO_Name) \
    static _COS_PDO_ENTRY _PDO_Table_##PDO_Name[] MCANOPEN_MAYBE_UNUSED = {

/* Reserved goes on as the event timer, ms; 0: off. */
#define PDO_ENTRY(COBid, TransMode, InhibitTime, TxTout, RxTout, Reserved, Mapping) \
        { (COBid), (TransMode), (InhibitTime), (TxTout), (RxTout), (Reserved), \
          _Mapping_##Mapping, NULL },

#define PDO_ENTRY_UNMAPPED(COBid, TransMode, InhibitTime, TxTout, RxTout, Reserved) \
        { (COBid), (TransMode), (InhibitTime), (TxTout), (RxTout), (Reserved), NULL, NULL },

#define END_PDO_TABLE() \
        { 0, 0, 0, 0, 0, 0, NULL, NULL } \
    };

/* The last entry of a table is that of its END macro and does not count. */
#define DECLARE_DICTIONARY(hNode, DictionaryName) \
    canopen_declare_dictionary_( \
        (hNode), _Dict_Entry_##DictionaryName, \
        sizeof _Dict_Entry_##DictionaryName / sizeof _Dict_Entry_##DictionaryName[0] - 1, \
        _Dict_Kind_##DictionaryName)

#define DECLARE_PDO(hNode, PDO_Name) \
    canopen_declare_pdos_( \
        (hNode), _PDO_Table_##PDO_Name, \
        sizeof _PDO_Table_##PDO_Name / sizeof _PDO_Table_##PDO_Name[0] - 1)

/* clang-format on */

/* what the macros above are made of, not for use by itself ------------------------------------- */

/* Writes the descriptor for all of a record, sub-index 0 included, to ret_types. */
MCANOPEN_INLINE int canopen_describe_record_(const char *types, unsigned short count,
                                             char ret_types[256])
{
    unsigned given = 0;
    unsigned i;

    if (!types || count > 254)
        return SCANOPEN_WRONG_PARAMETER;
    while (given < 256 && types[given])
        given++;
    if (given != 1 && given != count && given != count + 1U)
        return SCANOPEN_WRONG_TYPE;
    ret_types[0] = TYP_UINT8;
    for (i = 0; i < count; i++)
        ret_types[i + 1] = types[given == 1 ? 0 : given == count ? i : i + 1];
    ret_types[count + 1] = 0;
    return SCANOPEN_OK;
}

MCANOPEN_INLINE int canopen_extend_record_(HNODE node, unsigned short index, unsigned short count,
                                           const char *types)
{
    char all[256];
    DictionaryData number;
    int result = canopen_describe_record_(types, count, all);

    if (result == SCANOPEN_OK)
        result = canOpenExtendDictionary(node, index, count, OBJ_RECORD, all);
    if (result != SCANOPEN_OK)
        return result;
    number.uint8.val = number.uint8.defval = MCANOPEN_CAST(uint8_t, count);
    number.uint8.minval = number.uint8.maxval = 0;
    return canOpenInitDictionary(node, index, 0, NULL, READ_ACCESS, &number, NULL);
}

MCANOPEN_INLINE int canopen_extend_(HNODE node, unsigned short index, unsigned short count,
                                    unsigned short object, const char *types)
{
    if (object == OBJ_RECORD)
        return canopen_extend_record_(node, index, count, types);
    return canOpenExtendDictionary(node, index, count, object, types);
}

MCANOPEN_INLINE int canopen_declare_object_(HNODE node, const _COS_DICT_ENTRY *entry)
{
    unsigned sub = entry->ObjectType == OBJ_VAR ? 0 : 1;
    int result = canopen_extend_(node, entry->Index, entry->Subindex, entry->ObjectType,
                                 entry->DataType);

    for (; result == SCANOPEN_OK && sub <= entry->Subindex; sub++)
        result = canOpenInitDictionary(node, entry->Index, MCANOPEN_CAST(unsigned short, sub),
                                       entry->EntryName, entry->Flags, entry->Data, entry->Handler);
    return result;
}

MCANOPEN_INLINE int canopen_declare_object_ts_(HNODE node, const _COS_DICT_ENTRY_TS *entry)
{
    unsigned sub = entry->ObjectType == OBJ_VAR ? 0 : 1;
    int result = canopen_extend_(node, entry->Index, entry->Subindex, entry->ObjectType,
                                 entry->DataType);

    for (; result == SCANOPEN_OK && sub <= entry->Subindex; sub++)
        result = canOpenInitDictionaryTs(node, entry->Index, MCANOPEN_CAST(unsigned short, sub),
                                         entry->EntryName, entry->Flags, entry->Data,
                                         entry->Handler);
    return result;
}

MCANOPEN_INLINE int canopen_declare_dictionary_(HNODE node, const void *table, size_t count,
                                                int with_time)
{
    size_t i;
    int result = SCANOPEN_OK;

    for (i = 0; result == SCANOPEN_OK && i < count; i++)
        result = with_time ? canopen_declare_object_ts_(
                                 node, MCANOPEN_CAST(const _COS_DICT_ENTRY_TS *, table) + i)
                           : canopen_declare_object_(
                                 node, MCANOPEN_CAST(const _COS_DICT_ENTRY *, table) + i);
    return result;
}

MCANOPEN_INLINE int canopen_declare_pdos_(HNODE node, _COS_PDO_ENTRY *table, size_t count)
{
    size_t i;
    int result = SCANOPEN_OK;

    for (i = 0; result == SCANOPEN_OK && i < count; i++)
        result = canOpenDefinePDO(node, NULL, table[i].COBid, table[i].TransMode,
                                  table[i].InhibitTime, table[i].TxTout, table[i].RxTout,
                                  table[i].EventTimer, table[i].Mapping, &table[i].handle);
    return result;
}

/*
 * The manual prints descriptors as arrays of pointers, const char *d[] = {TYP_INT32, 0}, which C
 * compilers take with a warning: the "pointers" are type codes. C11 programs may go on using them.
 */
#if !defined(__cplusplus) && !defined(canOpenExtendDictionary) && defined(__STDC_VERSION__) &&     \
    __STDC_VERSION__ >= 201112L
MCANOPEN_INLINE int canopen_extend_by_pointers_(HNODE node, unsigned short index,
                                                unsigned short count, unsigned short object,
                                                const void *pointers)
{
    const char *const *codes = (const char *const *)pointers;
    char types[257];
    unsigned i;

    if (!codes)
        return SCANOPEN_WRONG_PARAMETER;
    for (i = 0; i < 256 && codes[i]; i++) {
        if ((uintptr_t)codes[i] > 127)
            return SCANOPEN_WRONG_TYPE;
        types[i] = (char)(uintptr_t)codes[i];
    }
    types[i] = 0;
    return canOpenExtendDictionary(node, index, count, object, types);
}

#define canOpenExtendDictionary(HNode, Index, Subentries, ObjectType, DataType)                    \
    _Generic((DataType),                                                        \
             char **: canopen_extend_by_pointers_,                              \
             const char **: canopen_extend_by_pointers_,                        \
             char *const *: canopen_extend_by_pointers_,                        \
             const char *const *: canopen_extend_by_pointers_,                  \
             default: canOpenExtendDictionary)((HNode), (Index), (Subentries),  \
                                               (ObjectType), (DataType))
#endif

#ifdef __cplusplus
}
#endif

#endif
