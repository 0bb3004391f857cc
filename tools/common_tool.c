#include "common_tool.h"

#include "api/error_map.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <strings.h>

#define NODE_ID_MAX 127

bool tool_print_version(const char *tool)
{
    return printf("%s %d.%d.%d\n", tool, MCANOPEN_VERSION_MAJOR, MCANOPEN_VERSION_MINOR,
                  MCANOPEN_VERSION_PATCH) >= 0;
}

bool tool_number(const char *text, unsigned least, unsigned most, unsigned *ret_number)
{
    const int base = strncasecmp(text, "0x", 2) == 0 ? 16 : 10; /* 010 is ten */
    char *end;
    const unsigned long number = strtoul(text, &end, base);

    if (!isxdigit((unsigned char)text[0]) || *end != '\0' || number < least || number > most)
        return false;
    *ret_number = (unsigned)number;
    return true;
}

bool tool_node_id(const char *text, uint8_t *ret_node_id)
{
    unsigned number;

    if (!tool_number(text, 1, NODE_ID_MAX, &number))
        return false;
    *ret_node_id = (uint8_t)number;
    return true;
}

#define CODE(code)                                                                                 \
    {                                                                                              \
        code, #code                                                                                \
    }

static const struct {
    int code;
    const char *text;
} codes[] = {
    CODE(CANOPEN_DCF_OUT_OF_MEMORY),   CODE(CANOPEN_DCF_MISSING_SECTION),
    CODE(CANOPEN_DCF_MISSING_ENTRY),   CODE(CANOPEN_DCF_WRONG_PARAMETER),
    CODE(CANOPEN_DCF_OUT_OF_RANGE),    CODE(CANOPEN_DCF_OUT_OF_LIMITS),
    CODE(CANOPEN_DCF_DOUBLE_SECTION),  CODE(CANOPEN_DCF_DOUBLE_KEYWORD),
    CODE(CANOPEN_DCF_UNKNOWN_KEYWORD), CODE(CANOPEN_DCF_WRONG_NODE_ID),
    CODE(CANOPEN_DCF_WRONG_BAUDRATE),  CODE(CANOPEN_DCF_WRONG_MODULE_NO),
};

const char *tool_dcf_code(int kind)
{
    const int code = kind ? error_of_dcf((enum dcf_error)kind) : 0;

    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++)
        if (codes[i].code == code)
            return codes[i].text;
    return NULL;
}
