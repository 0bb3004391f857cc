/*
 * What must hold at every moment in a plant, whatever happens to it:
 *
 *   - each device is in the NMT state in which CiA 301 has it after its last boot-up and the
 *     commands that it has heard since
 *   - the manager becomes operational by itself only when all mandatory nodes have booted and all
 *     others were tried
 *   - no slave gets NMT start before the manager is operational
 *   - a slave that the master boots gets it only with its whole configuration, in this life of the
 *     device (unless its boot-up message is still on the way, or lost: nobody can know then;
 *     or it overtook the start command, which then must be followed by a reset)
 *
 * A violation fails the test and tells the last frames on the wire; SCENARIO_LOG names a file for
 * all of them, and for the events.
 */
#ifndef TEST_SUPPORT_WATCH_H
#define TEST_SUPPORT_WATCH_H

#include "support/plant.h"

/* Looks at each frame that is delivered from now on. */
void watch_start(struct plant *plant);
/* Fails the test where it is not ok, as above. */
void watch_check(const struct plant *plant, bool ok, uint8_t node, const char *what);
/* All configured nodes that are there have booted, are configured and operational. */
void watch_expect_up(const struct plant *plant, const char *what);
/* True if all entries of the node's configuration are in the device. */
bool watch_is_configured(const struct plant *plant, uint8_t node);

#define WATCH_ENTRIES 5u

/*
 * A plant that is watched: nodes 5 and 6, each with 6200h:01..05 = 51h..55h to be written; further
 * nodes of the XML are absent. It is not powered on.
 */
struct plant *watch_two(const char *xml);

#endif
