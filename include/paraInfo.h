/*
 * Texts for the events of mcanOpenEvent: one table for each member of EVENT_T.para, indexed by the
 * least significant byte of EVENT_T.event.
 *
 *   if ((event.event & PARA) == PARA_I)
 *       printf("%s %d\n", iParaInfo[event.event & 0xFF], event.para.i);
 *
 * Every entry is plain text: not NULL, no format, no newline. Numbers that have no message yet say
 * so. mcanOpenEventText (ours) formats a whole event with them.
 */
#ifndef PARA_INFO_H
#define PARA_INFO_H

#include "mcanopen_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define PARA_INFO_SIZE 256 /* ours */

MCANOPEN_API extern const char *const cParaInfo[PARA_INFO_SIZE];
MCANOPEN_API extern const char *const ucParaInfo[PARA_INFO_SIZE];
MCANOPEN_API extern const char *const sParaInfo[PARA_INFO_SIZE];
MCANOPEN_API extern const char *const usParaInfo[PARA_INFO_SIZE];
MCANOPEN_API extern const char *const iParaInfo[PARA_INFO_SIZE];
MCANOPEN_API extern const char *const uiParaInfo[PARA_INFO_SIZE];
MCANOPEN_API extern const char *const lParaInfo[PARA_INFO_SIZE];
MCANOPEN_API extern const char *const ulParaInfo[PARA_INFO_SIZE];
MCANOPEN_API extern const char *const writeParaInfo[PARA_INFO_SIZE];
MCANOPEN_API extern const char *const strParaInfo[PARA_INFO_SIZE];

#ifdef __cplusplus
}
#endif

#endif
