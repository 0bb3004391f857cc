/* TIME: canOpenSendTime, and what a node's handler is told (EV_TIME). */
#include "api/scan.h"

#include <time.h>

#define SECONDS_TO_1984 441763200LL /* from 1970-01-01 */
#define SECONDS_PER_DAY 86400
#define DAYS_MAX        UINT16_MAX

/* The system's clock in UTC; before 1984 and after 2163 its ends. */
static struct time_of_day system_time(void)
{
    struct timespec clock;
    long long seconds;

    clock_gettime(CLOCK_REALTIME, &clock);
    seconds = (long long)clock.tv_sec - SECONDS_TO_1984;
    if (seconds < 0)
        return (struct time_of_day){ .ms = 0, .days = 0 };
    if (seconds / SECONDS_PER_DAY > DAYS_MAX)
        return (struct time_of_day){ .ms = TIME_MS_MAX, .days = DAYS_MAX };
    return (struct time_of_day){ .ms = (uint32_t)(seconds % SECONDS_PER_DAY) * 1000u +
                                       (uint32_t)(clock.tv_nsec / 1000000),
                                 .days = (uint16_t)(seconds / SECONDS_PER_DAY) };
}

static int send_time(struct scan_node *node, const struct time_of_day *time)
{
    enum co_err err = CO_ERR_STATE;
    co_us_t now;
    struct co_outbox *out = scan_lock(node, &now);

    if (node->active)
        err = slave_send_time(&node->slave, time, out);
    scan_unlock(node);
    return scan_error_of_send(err);
}

int canOpenSendTime(HNODE HNode, const CAN_TIME_OF_DAY *Time)
{
    struct time_of_day time;
    struct scan_node *node;
    int result = scan_enter(HNode, &node);

    if (result != SCANOPEN_OK)
        return result;
    if (Time && Time->ulMs > TIME_MS_MAX) {
        result = SCANOPEN_WRONG_PARAMETER;
    } else {
        time = Time ? (struct time_of_day){ .ms = (uint32_t)Time->ulMs, .days = Time->usDays }
                    : system_time();
        result = send_time(node, &time);
    }
    scan_leave(node);
    return result;
}

CAN_TIME_OF_DAY scan_time_of(const struct co_event *news)
{
    return (CAN_TIME_OF_DAY){ .ulMs = news->code, .usDays = news->index };
}
