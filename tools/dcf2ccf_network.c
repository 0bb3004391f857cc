/* The files that a manager would write at boot: it is asked itself, by the functions it uses. */
#include "dcf2ccf.h"

#include "api/file.h"
#include "api/load.h"
#include "common_file.h"
#include "mcanopen.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct plant {
    const struct dcf2ccf_arguments *arguments;
    struct ccf_files *files;
    const char *folder; /* with its "/", or "" */
    struct network_config *networks;
    size_t count;
};

static bool tell_no_memory(const struct plant *self)
{
    file_tell("dcf2ccf", self->arguments->network, CO_ERR_MEMORY);
    return false;
}

static void tell_nothing(const struct plant *self, const char *path)
{
    struct co_report report = { .file = path, .sink = file_report_line };

    if (!self->arguments->quiet)
        co_report_add(&report, CO_WARNING, 0,
                      "nothing to write: no writable entry has a ParameterValue");
}

/* DownloadFile; of an entry that is left out it may be one that is not there. */
static bool note_downloads(const struct plant *self, const char *path, const struct dcf *dcf)
{
    char *folder = file_folder(path);
    bool good = folder != NULL;

    for (size_t i = 0; good && i < dcf->count; i++) {
        char *name;

        if (!dcf->entries[i].download_file)
            continue;
        good = asprintf(&name, "%s%s", folder, dcf->entries[i].download_file) >= 0;
        if (good) {
            good = access(name, F_OK) != 0 || ccf_files_read(self->files, name);
            free(name);
        }
    }
    free(folder);
    return good || tell_no_memory(self);
}

static bool note_inputs(const struct plant *self, const char *path)
{
    struct co_report unheard = { .file = path };
    struct dcf dcf;
    bool good;

    if (load_dcf(path, &unheard, &dcf) != MCANOPEN_OK) {
        fprintf(stderr, "dcf2ccf: %s: it has changed meanwhile\n", path);
        return false;
    }
    good = ccf_files_read(self->files, path) && note_downloads(self, path, &dcf);
    dcf_done(&dcf);
    return good;
}

static bool read_node(const struct plant *self, const struct network_config *network,
                      const struct node_config *node)
{
    char *path;
    bool good;

    if (file_find(network, self->arguments->network, node->dcf_file, &path) != CO_OK)
        return tell_no_memory(self);
    good = note_inputs(self, path);
    if (ccf_count(&node->ccf) == 0)
        tell_nothing(self, path);
    free(path);
    return good;
}

/* Numbers of nodes are unique within their network, and numbers of networks within the file. */
static bool write_node(const struct plant *self, const struct network_config *network,
                       const struct node_config *node)
{
    char net[32] = "", *name;
    bool good;

    if (self->count > 1)
        snprintf(net, sizeof net, "net-%u-", network->net);
    if (asprintf(&name, "%s%snode-%u.ccf", self->folder, net, node->node_id) < 0)
        return tell_no_memory(self);
    good = ccf_files_write(self->files, name, node->ccf.bytes, node->ccf.size);
    free(name);
    return good;
}

/* All are read before the first is written: no output may be an input of another node. */
static bool for_each_node(const struct plant *self,
                          bool (*function)(const struct plant *, const struct network_config *,
                                           const struct node_config *))
{
    for (size_t i = 0; i < self->count; i++) {
        const struct network_config *network = &self->networks[i];

        for (size_t k = 0; k < network->node_count; k++) {
            const struct node_config *node = &network->nodes[k];

            if (node->dcf_file && !function(self, network, node))
                return false;
        }
    }
    return true;
}

static char *folder_of(const struct dcf2ccf_arguments *arguments)
{
    const char *output = arguments->output;
    char *folder;

    if (!output)
        return file_folder(arguments->network);
    if (asprintf(&folder, "%s/", output) < 0)
        return NULL;
    return folder;
}

static bool convert(struct plant *self)
{
    char *folder = folder_of(self->arguments);
    bool good;

    if (!folder)
        return tell_no_memory(self);
    self->folder = folder;
    good = ccf_files_read(self->files, self->arguments->network) &&
           for_each_node(self, read_node) && for_each_node(self, write_node);
    if (good && self->files->written_count == 0) {
        fprintf(stderr, "dcf2ccf: %s: a node with a DCF_File expected, there is none\n",
                self->arguments->network);
        good = false;
    }
    free(folder);
    return good;
}

bool dcf2ccf_convert_network(const struct dcf2ccf_arguments *arguments, struct ccf_files *files)
{
    struct co_report report = { .sink = arguments->quiet ? file_report_error : file_report_line };
    struct plant plant = { .arguments = arguments, .files = files };
    bool good;

    if (load_networks(arguments->network, &report, &plant.networks, &plant.count) != MCANOPEN_OK)
        return false;
    good = convert(&plant);
    network_config_free(plant.networks, plant.count);
    return good;
}
