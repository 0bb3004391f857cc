#include "od/abort.h"

#include <stddef.h>

static const struct {
    sdo_abort_t code;
    const char *text;
} texts[] = {
    { SDO_OK, "no abort" },
    { SDO_TOGGLE, "toggle bit not alternated" },
    { SDO_TIMEOUT, "SDO protocol timed out" },
    { SDO_COMMAND, "command specifier not valid or unknown" },
    { SDO_BLOCK_SIZE, "invalid block size" },
    { SDO_BLOCK_SEQUENCE, "invalid sequence number" },
    { SDO_BLOCK_CRC, "CRC error" },
    { SDO_NO_MEMORY, "out of memory" },
    { SDO_ACCESS, "object does not support this access" },
    { SDO_WRITE_ONLY, "object is write-only" },
    { SDO_READ_ONLY, "object is read-only" },
    { SDO_NO_OBJECT, "object does not exist" },
    { SDO_NOT_MAPPABLE, "object cannot be mapped to a PDO" },
    { SDO_PDO_LENGTH, "mapped objects exceed the PDO length" },
    { SDO_PARAMETER, "parameters are incompatible" },
    { SDO_INTERNAL, "incompatibility inside the device" },
    { SDO_HARDWARE, "access failed because of a hardware error" },
    { SDO_TYPE_LENGTH, "length does not match the data type" },
    { SDO_TOO_LONG, "length too high for the data type" },
    { SDO_TOO_SHORT, "length too low for the data type" },
    { SDO_NO_SUB, "sub-index does not exist" },
    { SDO_INVALID_VALUE, "invalid value" },
    { SDO_VALUE_HIGH, "value too high" },
    { SDO_VALUE_LOW, "value too low" },
    { SDO_MAX_BELOW_MIN, "maximum is less than minimum" },
    { SDO_NO_CONNECTION, "no SDO connection available" },
    { SDO_GENERAL, "general error" },
    { SDO_NOT_STORED, "data cannot be transferred or stored" },
    { SDO_LOCAL_CONTROL, "data cannot be stored: local control" },
    { SDO_DEVICE_STATE, "data cannot be stored in the present device state" },
    { SDO_NO_DICTIONARY, "no object dictionary present" },
    { SDO_NO_DATA, "no data available" },
};

const char *sdo_abort_text(sdo_abort_t code)
{
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        if (texts[i].code == code)
            return texts[i].text;
    }
    return "unknown abort code";
}
