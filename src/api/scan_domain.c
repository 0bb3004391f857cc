/* Domains in files: canOpenSetDomainFile, and reading them. scan_sdo.c writes. */
#include "api/scan.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SIZE_MOST 0x7FFFFFFFul /* of an SDO transfer here */

#define FIRST_OBJECT 0x2000u

static struct scan_domain *make_domain(const char *path, uint32_t max)
{
    const size_t size = strlen(path) + 1;
    struct scan_domain *domain = malloc(sizeof *domain + size);

    if (domain) {
        domain->max = max;
        memcpy(domain->path, path, size);
    }
    return domain;
}

struct scan_domain *scan_copy_domain(const struct scan_domain *domain)
{
    return make_domain(domain->path, domain->max);
}

/* ---- canOpenSetDomainFile ---- */

struct order {
    uint16_t index, sub;
    const char *path;
    unsigned long max;
};

static int set_file(struct scan_node *node, const struct order *order)
{
    struct od_entry *entry = order->sub <= UINT8_MAX
                                 ? od_find(&node->od, order->index, (uint8_t)order->sub)
                                 : NULL;
    struct scan_entry *owner = entry ? entry->owner : NULL;
    struct scan_domain *domain;

    if (node->active)
        return SCANOPEN_WRONG_NODESTATE;
    if (order->index < FIRST_OBJECT || !od_has_object(&node->od, order->index))
        return SCANOPEN_WRONG_INDEX;
    if (!owner)
        return SCANOPEN_WRONG_SUBINDEX;
    if (!owner->initialized || entry->type != OD_DOMAIN)
        return SCANOPEN_WRONG_TYPE;
    domain = make_domain(order->path, (uint32_t)order->max);
    if (!domain)
        return SCANOPEN_OUT_OF_MEMORY;
    free(owner->domain);
    owner->domain = domain;
    od_fetch(entry, domain->max);
    return SCANOPEN_OK;
}

int canOpenSetDomainFile(HNODE HNode, unsigned short Index, unsigned short Subindex,
                         const char *FileName, unsigned long MaxSize)
{
    const struct order order = {
        .index = Index, .sub = Subindex, .path = FileName, .max = MaxSize
    };
    struct scan_node *node;
    int result = scan_enter(HNode, &node);

    if (result != SCANOPEN_OK)
        return result;
    network_hold(node->net->network);
    if (!FileName || FileName[0] == '\0' || MaxSize == 0 || MaxSize > SIZE_MOST)
        result = SCANOPEN_WRONG_PARAMETER;
    else
        result = set_file(node, &order);
    network_release(node->net->network);
    scan_leave(node);
    return result;
}

/* ---- for the SDO daemon ---- */

sdo_abort_t scan_error_of_file(enum co_err err)
{
    if (err == CO_OK)
        return SDO_OK;
    return err == CO_ERR_MEMORY ? SDO_NO_MEMORY : SDO_HARDWARE;
}

/* Up to 'size' bytes; fewer where the file ends. False: the system refuses. */
static bool read_all(int file, uint8_t *bytes, size_t size, size_t *ret_size)
{
    *ret_size = 0;
    while (*ret_size < size) {
        const ssize_t got = read(file, bytes + *ret_size, size - *ret_size);

        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return got == 0;
        *ret_size += (size_t)got;
    }
    return true;
}

static sdo_abort_t read_open(int file, uint32_t max, uint8_t **ret_bytes, uint32_t *ret_size)
{
    struct stat status;
    uint8_t *bytes;
    size_t size;

    if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode))
        return SDO_HARDWARE;
    if ((uint64_t)status.st_size > max)
        return SDO_TOO_LONG;
    bytes = malloc((size_t)status.st_size + 1);
    if (!bytes)
        return SDO_NO_MEMORY;
    if (!read_all(file, bytes, (size_t)status.st_size, &size)) {
        free(bytes);
        return SDO_HARDWARE;
    }
    *ret_bytes = bytes;
    *ret_size = (uint32_t)size;
    return SDO_OK;
}

sdo_abort_t scan_read_domain(const struct scan_domain *domain, uint8_t **ret_bytes,
                             uint32_t *ret_size)
{
    /* A pipe must not make it wait. */
    const int file = open(domain->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    sdo_abort_t code;

    if (file < 0)
        return errno == ENOENT ? SDO_NO_DATA : SDO_HARDWARE;
    code = read_open(file, domain->max, ret_bytes, ret_size);
    close(file);
    return code;
}
