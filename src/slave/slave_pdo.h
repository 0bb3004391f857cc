/*
 * Process data and SYNC of a local device: its PDOs by number, what the application does with them,
 * and what the owner has to know to let the right frames in and to send SYNC by other means.
 *
 * RPDO n is 1400h+n-1 with its mapping 1600h+n-1, TPDO n is 1800h+n-1 with 1A00h+n-1, n = 1..512.
 * slave_init() finds those that the dictionary has; numbers may have gaps.
 *
 * On a SYNC the TPDOs go out first, but for those that ask for data, then the data of RPDOs is
 * taken over. What finds no room in the outbox stays due, and is done first in the next call.
 *
 *   owner    as the device (slave.h includes this)
 *   locking  none; the owner's
 */
#ifndef CO_SLAVE_SLAVE_PDO_H
#define CO_SLAVE_SLAVE_PDO_H

#include "base/error.h"
#include "base/outbox.h"
#include "base/time.h"
#include "od/od.h"
#include "proto/rpdo.h"
#include "proto/tpdo.h"

#define SLAVE_PDO_NUMBER_MAX 512u

struct slave;

enum pdo_direction { PDO_RECEIVE, PDO_TRANSMIT };

/* What the owner says of a PDO. */
#define SLAVE_PDO_NOTIFY     0x01u /* RPDO: SLAVE_RPDO with all data; TPDO: sent with each change */
#define SLAVE_PDO_CONFIRM    0x02u /* TPDO: SLAVE_TPDO_CONFIRMED when its own frame comes back */
#define SLAVE_PDO_TIMER_ASKS 0x04u /* TPDO: the event timer asks for new data first */

/* A PDO that does not exist is left out. Flags stay until slave_done(). */
void slave_pdo_set_flags(struct slave *self, enum pdo_direction direction, uint16_t number,
                         uint8_t flags);

/* NULL: there is none. The owner may count rpdo.waiters. */
struct rpdo *slave_rpdo(const struct slave *self, uint16_t number);
struct tpdo *slave_tpdo(const struct slave *self, uint16_t number);

/*
 * Sends an asynchronous TPDO (types 254, 255); one of type 0 is sent with the next SYNC.
 *
 *   CO_ERR_ARG        no such TPDO: not there, another type, not valid, nothing mapped
 *   CO_ERR_STATE      not operational
 *   CO_ERR_INHIBITED  goes out when the inhibit time ends
 *   CO_ERR_AGAIN      no room in the outbox; goes out when there is
 */
enum co_err slave_pdo_send(struct slave *self, uint16_t number, co_us_t now, struct co_outbox *out);

/*
 * The application has changed an entry: the TPDOs that map it are sent (254 and 255 with
 * SLAVE_PDO_NOTIFY), or will be with the next SYNC (type 0); a communication parameter takes
 * effect. The worst of CO_OK, CO_ERR_INHIBITED, CO_ERR_AGAIN, as above.
 */
enum co_err slave_entry_changed(struct slave *self, struct od_entry *entry, co_us_t now,
                                struct co_outbox *out);
/* What slave_entry_changed() does depends on the time. If not, it may be told of an old one. */
bool slave_entry_is_timed(const struct slave *self, const struct od_entry *entry);
/* A TPDO of type 254 or 255 with SLAVE_PDO_NOTIFY maps it. */
bool slave_entry_is_sent(const struct slave *self, const struct od_entry *entry);

/*
 * While held, TPDOs with SLAVE_PDO_NOTIFY are not sent because of changed entries; the end sends
 * those that changed, once.
 */
void slave_hold_transmission(struct slave *self, bool hold, co_us_t now, struct co_outbox *out);

/*
 * The data that SLAVE_TPDO_WANTED asked for with this number is in the dictionary: it goes out.
 * Without an answer it goes out at the end of the synchronous window (1007h; if 0, half of 1006h,
 * at most 10 ms), or after 10 ms, with the data there; a later answer is ignored.
 */
void slave_tpdo_answer(struct slave *self, uint16_t number, uint32_t ask, co_us_t now,
                       struct co_outbox *out);

/*
 * Asks for an RPDO's data with a remote frame.
 * CO_ERR_ARG: no such RPDO, or not valid; CO_ERR_STATE: not operational; CO_ERR_AGAIN: no room.
 */
enum co_err slave_rpdo_request(struct slave *self, uint16_t number, co_us_t now,
                               struct co_outbox *out);

/*
 * Somebody waits for such a frame to be on the bus, or does no more: rpdo.asked counts it, with a
 * SLAVE_RPDO_ASKED where there is room for one.
 */
void slave_expect_request(struct slave *self, uint16_t number, bool expect);

/* A frame that the device wants to hear. */
struct slave_filter {
    uint32_t id;
    bool ext;
    bool rtr;
};

/*
 * Fills in the first max of all that the device wants to hear, each once; returns how many there
 * are. The list may have changed when slave.listen_generation has.
 */
unsigned slave_listens(const struct slave *self, struct slave_filter *ret_filters, unsigned max);

/* Some TPDO has SLAVE_PDO_CONFIRM, or a request is expected. */
bool slave_wants_own_frames(const struct slave *self);

/*
 * How SYNC is to be sent. Whoever sends it instead of the device starts anew, with counter 1, when
 * slave.sync_generation has changed.
 */
struct slave_sync_plan {
    bool active;
    uint32_t cob_id; /* CAN-ID */
    bool ext;
    uint8_t overflow; /* of the counter, 1019h; 0: SYNCs have no data */
    co_us_t period;
};

void slave_sync_plan(const struct slave *self, struct slave_sync_plan *ret_plan);
/*
 * Somebody else (the kernel) sends SYNC; the device expects the frames to come back, not marked as
 * own, and tells SLAVE_SYNC_MISSING when none do.
 */
void slave_sync_external(struct slave *self, bool external);

/* May a PDO in this direction use this COB-ID? One that is not valid may have any. */
bool slave_may_use(const struct od *od, uint32_t cob_id, bool transmit);

/*
 * May an object be mapped? mapping_entry as in 1600h.., for a PDO in this direction. How many PDOs
 * it is in does not matter.
 */
sdo_abort_t slave_check_mapped(const struct od *od, uint32_t mapping_entry, bool transmit);

#endif
