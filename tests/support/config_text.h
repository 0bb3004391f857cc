/* Configuration files of tests: their frame, and what reading them gives. */
#ifndef CO_TESTS_CONFIG_TEXT_H
#define CO_TESTS_CONFIG_TEXT_H

#include "manager/network_config.h"

/* What stands in the network begins at line 5 of the file, in the node at line 7. */
#define NET(inner)                                                                                 \
    "<CANopen_Manager>\n<Manager_Instance>\n<Net_No>0</Net_No>\n<Baudrate>500</Baudrate>\n" inner  \
    "</Manager_Instance>\n</CANopen_Manager>\n"
#define NODE(inner) NET("<Node_Instance>\n<Node_Id>5</Node_Id>\n" inner "</Node_Instance>\n")
#define ONE         "<Node_Instance><Node_Id>5</Node_Id></Node_Instance>\n"

struct config_result {
    enum co_err err;
    struct co_report report;
    struct network_config *networks;
    size_t count;
    char messages[20000]; /* one in a line, without the file's name */
};

/* Valid until the next one; the networks are the caller's. */
struct config_result *config_parse_bytes(const char *text, size_t size);
struct config_result *config_parse(const char *text);

/* The network of a file without any message, for network_config_free(..., 1). */
struct network_config *config_parse_one(const char *text);

#endif
