/* Networks of local slaves: canOpenCreateNetwork(Ex), canOpenRemoveNetwork; their daemons. */
#include "api/callback.h"
#include "api/log.h"
#include "api/nets.h"
#include "api/registry.h"
#include "api/scan.h"

#include <stdio.h>
#include <stdlib.h>

#define NMT_EVENTS    1024u
#define EMCY_EVENTS   256u
#define DAEMONS       4u
#define TOKENS        (2u * NMT_NODE_MAX) /* one for each node, and one that has just been taken */
#define PORTABLE_MAX  31
#define NATIVE_MAX    99
#define OPTIONS_KNOWN (THREAD_PRIOS_OVERWRITE | THREAD_PRIOS_NATIVE | NORMALIZE_TIMESTAMPS)

static bool is_baudrate(unsigned kbit)
{
    static const unsigned rates[] = {
        BAUDRATE_AS_IT_IS, 10, 20, 50, 100, 125, 250, 500, 800, 1000
    };

    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++)
        if (rates[i] == kbit)
            return true;
    return false;
}

/* ---- priorities ---- */

struct priorities {
    bool given;
    int native[PRIOS]; /* 0: as the system has it */
};

static bool read_priorities(const SLAVE_NET_INFO *info, struct priorities *ret_priorities)
{
    const short given[PRIOS] = { info->sPrioNMT, info->sPrioSDO, info->sPrioPDO, info->sPrioEMCY };
    const bool native = (info->ulOptions & THREAD_PRIOS_NATIVE) != 0;

    *ret_priorities = (struct priorities){ .given = (info->ulOptions & THREAD_PRIOS_OVERWRITE) !=
                                                    0 };
    if (!ret_priorities->given)
        return true;
    for (unsigned i = 0; i < PRIOS; i++) {
        if (given[i] < 0 || given[i] > (native ? NATIVE_MAX : PORTABLE_MAX))
            return false;
        ret_priorities->native[i] = native ? given[i] : thread_native_priority(given[i]);
    }
    return true;
}

static int highest(const struct priorities *priorities)
{
    int result = 0;

    for (unsigned i = 0; i < PRIOS; i++)
        if (priorities->native[i] > result)
            result = priorities->native[i];
    return result;
}

static enum co_err set_daemons(struct scan_net *net, const int native[PRIOS])
{
    struct daemon *const daemons[PRIOS] = { [PRIO_NMT] = &net->nmt,
                                            [PRIO_SDO] = &net->sdo,
                                            [PRIO_PDO] = &net->pdo,
                                            [PRIO_EMCY] = &net->emcy };
    enum co_err err = CO_OK;

    for (unsigned i = 0; i < PRIOS && err != CO_ERR_PERMISSION; i++)
        err = daemon_set_priority(daemons[i], native[i]);
    return err;
}

/* The manager's file may say something about this network's daemons. */
static bool read_manager_priorities(int number, int native[PRIOS])
{
    struct managed *managed;
    bool given;

    if (registry_enter(number, false, &managed) != MCANOPEN_OK)
        return false;
    given = priority_of_slaves(managed->config, native);
    registry_leave();
    return given;
}

static void set_priorities(struct scan_net *net, struct priorities *priorities)
{
    enum co_err err = CO_OK;
    bool of_manager;

    if (priorities->given)
        err = network_claim_priority(net->network, highest(priorities));
    if (err == CO_ERR_EXISTS)
        log_put(CO_WARNING, "thread priorities: the manager of this network has set them before; "
                            "those count");
    of_manager = read_manager_priorities(net->number, priorities->native);
    net->has_priorities = priorities->given && !of_manager;
    if (err != CO_ERR_PERMISSION && (priorities->given || of_manager))
        err = set_daemons(net, priorities->native);
    if (err == CO_ERR_PERMISSION)
        log_put(CO_WARNING, "no right to set thread priorities (CAP_SYS_NICE, or ulimit -r): the "
                            "threads run with the default ones");
}

enum co_err scan_adopt_priorities(int number, const int native[PRIOS])
{
    struct scan_net *net;
    enum co_err err = CO_OK;

    scan_begin_change();
    net = scan_net(number);
    if (net && !net->has_priorities)
        err = set_daemons(net, native);
    scan_end_change();
    return err;
}

/* ---- opening ---- */

/* Started in this order, and stopped in the other one. */
static unsigned start_daemons(struct scan_net *net)
{
    const struct {
        struct daemon *daemon;
        const char *name;
        size_t element;
        unsigned capacity;
    } daemons[] = { { &net->nmt, "mcan-nmt", sizeof(struct scan_event_token), NMT_EVENTS },
                    { &net->emcy, "mcan-emcy", sizeof(struct scan_emcy_token), EMCY_EVENTS },
                    { &net->pdo, "mcan-pdo", sizeof(struct scan_token), TOKENS },
                    { &net->sdo, "mcan-sdo", sizeof(struct scan_token), TOKENS } };
    unsigned started = 0;

    net->nmt = (struct daemon){ .work = scan_nmt_work, .lost = scan_nmt_lost, .context = net };
    net->emcy = (struct daemon){ .work = scan_emcy_work, .lost = scan_emcy_lost, .context = net };
    net->pdo = (struct daemon){ .work = scan_pdo_work, .context = net };
    net->sdo = (struct daemon){ .work = scan_sdo_work, .context = net };
    while (started < DAEMONS &&
           daemon_start(daemons[started].daemon, daemons[started].name, daemons[started].element,
                        daemons[started].capacity) == CO_OK)
        started++;
    return started;
}

static void stop_daemons(struct scan_net *net, unsigned started)
{
    struct daemon *const daemons[DAEMONS] = { &net->nmt, &net->emcy, &net->pdo, &net->sdo };

    if (net->stores)
        daemon_stop(&net->store);
    while (started > 0)
        daemon_stop(daemons[--started]);
}

static int error_of_open(enum co_err err)
{
    if (err == CO_OK)
        return SCANOPEN_OK;
    if (err == CO_ERR_EXISTS)
        return SCANOPEN_WRONG_PARAMETER;
    if (err == CO_ERR_BITRATE)
        return SCANOPEN_WRONG_BAUDRATE;
    return err == CO_ERR_MEMORY ? SCANOPEN_OUT_OF_MEMORY : SCANOPEN_INIT_ERRORS;
}

static int open_network(struct scan_net *net, const SLAVE_NET_INFO *info)
{
    const unsigned bitrate = info->usBaudrate == BAUDRATE_AS_IT_IS ? 0 : info->usBaudrate;
    char message[CO_REPORT_TEXT_SIZE] = "";
    const struct net_order order = { .number = net->number,
                                     .user = NET_SLAVES,
                                     .bitrate = bitrate,
                                     .sink = scan_on_net_event,
                                     .context = net };
    const enum co_err err = nets_open(&order, &net->network, message, sizeof message);

    if (err != CO_OK && message[0] != '\0')
        log_put(CO_ERROR, message);
    return error_of_open(err);
}

static int open_and_start(struct scan_net *net, const SLAVE_NET_INFO *info,
                          struct priorities *priorities)
{
    int result = open_network(net, info);
    unsigned started;

    if (result != SCANOPEN_OK)
        return result;
    started = start_daemons(net);
    if (started == DAEMONS && network_run(net->network) == CO_OK) {
        set_priorities(net, priorities);
        if (net->debug_mask != 0)
            network_trace(net->network);
        return SCANOPEN_OK;
    }
    stop_daemons(net, started);
    nets_close(net->number, NET_SLAVES);
    return SCANOPEN_CANNOT_START_DAEMON;
}

static int create_network(int number, const SLAVE_NET_INFO *info)
{
    struct priorities priorities;
    struct scan_net *net;
    int result;

    if (scan_net(number) || !read_priorities(info, &priorities))
        return SCANOPEN_WRONG_PARAMETER;
    if (!is_baudrate(info->usBaudrate))
        return SCANOPEN_WRONG_BAUDRATE;
    net = calloc(1, sizeof *net);
    if (!net)
        return SCANOPEN_OUT_OF_MEMORY;
    net->number = number;
    net->options = info->ulOptions;
    net->debug_mask = info->usDebugMask;
    result = open_and_start(net, info, &priorities);
    if (result == SCANOPEN_OK)
        scan_set_net(number, net);
    else
        free(net);
    return result;
}

int canOpenCreateNetworkEx(int NetNo, const SLAVE_NET_INFO *pNetInfo)
{
    int result;

    if (callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    if (NetNo < 0 || NetNo >= (int)SCAN_NETWORKS || !pNetInfo ||
        (pNetInfo->ulOptions & ~OPTIONS_KNOWN) != 0)
        return SCANOPEN_WRONG_PARAMETER;
    scan_begin_change();
    result = create_network(NetNo, pNetInfo);
    scan_end_change();
    return result;
}

int canOpenCreateNetwork(int NetNo, const char *NetName, unsigned short Baudrate)
{
    const SLAVE_NET_INFO info = { .pNetName = NetName, .usBaudrate = Baudrate };

    return canOpenCreateNetworkEx(NetNo, &info);
}

/* ---- closing ---- */

static int remove_network(int number)
{
    struct scan_net *net = scan_net(number);

    if (!net)
        return SCANOPEN_WRONG_PARAMETER;
    if (net->nodes > 0)
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    nets_silence(number, NET_SLAVES);
    network_settle(net->network);
    stop_daemons(net, DAEMONS);
    nets_close(number, NET_SLAVES);
    scan_set_net(number, NULL);
    free(net);
    return SCANOPEN_OK;
}

int canOpenRemoveNetwork(int NetNo)
{
    int result;

    if (callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    if (NetNo < 0 || NetNo >= (int)SCAN_NETWORKS)
        return SCANOPEN_WRONG_PARAMETER;
    scan_begin_change();
    result = remove_network(NetNo);
    scan_end_change();
    return result;
}
