/* The lists of objects, the modules and the PDO counts against what is described. */
#include "dcf/dcf_build.h"

#include <stdlib.h>

#define FIRST_OBJECT 0x1000u
#define LAST_TYPE    0x025Fu
#define IDENTITY     0x1018u /* mandatory since version 4 of the files */
#define PDOS_MAX     512u

static const struct list {
    enum dcf_section_kind kind;
    const char *name;
} lists[] = {
    { DCF_SECTION_MANDATORY, "MandatoryObjects" },
    { DCF_SECTION_OPTIONAL, "OptionalObjects" },
    { DCF_SECTION_MANUFACTURER, "ManufacturerObjects" },
};

#define LIST_COUNT (sizeof lists / sizeof lists[0])

static bool is_mandatory(uint32_t index)
{
    return index == 0x1000 || index == 0x1001 || index == IDENTITY;
}

/* Data types that a device brings along may be in the lists of both. */
static bool belongs(const struct dcf_builder *self, enum dcf_section_kind list, uint32_t index)
{
    bool manufacturer = index >= 0x2000 && index <= 0x5FFF;

    if (index > 0 && index <= LAST_TYPE)
        return list != DCF_SECTION_MANDATORY;
    if (list == DCF_SECTION_MANDATORY)
        return is_mandatory(index);
    if (list == DCF_SECTION_MANUFACTURER)
        return manufacturer;
    if (index == IDENTITY && self->eds_version < EDS_VERSION_4)
        return true;
    return index >= FIRST_OBJECT && !is_mandatory(index) && !manufacturer;
}

static const char *list_of(uint32_t index)
{
    if (is_mandatory(index))
        return "[MandatoryObjects]";
    if (index >= 0x2000 && index <= 0x5FFF)
        return "[ManufacturerObjects]";
    return index >= FIRST_OBJECT || (index > 0 && index <= LAST_TYPE) ? "[OptionalObjects]"
                                                                      : "no list";
}

struct place {             /* of an index */
    unsigned list_line;    /* 0: in no list */
    unsigned section_line; /* 0: there is no section */
};

struct lister {
    struct dcf_builder *builder;
    struct place *places;
};

static void take_listed(void *context, const struct dcf_section *section, const struct dcf_key *key,
                        unsigned number)
{
    struct lister *self = context;
    struct co_report *report = self->builder->report;
    struct place *place;
    uint16_t index;

    (void)number;
    if (!dcf_key_index(self->builder, section, key, &index))
        return;
    place = &self->places[index];
    if (place->list_line != 0)
        dcf_tell(report, DCF_RULE_LISTED_TWICE, key->line,
                 "[%s]: %04Xh expected once, it is also in line %u", dcf_show(section->name).text,
                 index, place->list_line);
    else if (!belongs(self->builder, section->kind, index))
        dcf_tell(report, DCF_RULE_WRONG_LIST, key->line, "[%s]: %04Xh expected in %s, it is here",
                 dcf_show(section->name).text, index, list_of(index));
    if (place->section_line == 0 && !dcf_has_object(self->builder->dcf, index))
        dcf_tell(report, DCF_RULE_LISTED_MISSING, key->line,
                 "[%s]: a section [%04X] for this index expected, it is missing",
                 dcf_show(section->name).text, index);
    place->list_line = key->line;
}

/* Lists without entries may be left out: what is in none is told with the object. */
static void check_list(struct dcf_builder *self, const struct list *list, struct place *places)
{
    static const struct dcf_numbered form = { .count_key = "SupportedObjects",
                                              .other_count_key = "Supported Objects",
                                              .prefix = "",
                                              .rule = DCF_RULE_LIST_COUNT,
                                              .take = take_listed };
    struct dcf_section *section = dcf_text_find(&self->text, list->kind);
    struct lister lister = { self, places };

    if (section) {
        dcf_read_numbered(self, section, &form, &lister);
        dcf_tell_unused(self, section);
    } else if (list->kind == DCF_SECTION_MANDATORY) {
        dcf_tell(self->report, DCF_RULE_SECTION_MISSING, 0,
                 "a section [%s] expected, it is missing", list->name);
    }
}

static void check_sections(struct dcf_builder *self, const struct place *places)
{
    for (size_t i = 0; i < self->text.section_count; i++) {
        const struct dcf_section *section = &self->text.sections[i];

        if (section->kind == DCF_SECTION_OBJECT && section->index >= FIRST_OBJECT &&
            places[section->index].list_line == 0)
            dcf_tell(self->report, DCF_RULE_NOT_LISTED, section->line,
                     "[%04X]: its index expected in %s, it is in no list", section->index,
                     list_of(section->index));
    }
}

static void check_mandatory(struct dcf_builder *self)
{
    static const uint16_t mandatory[] = { 0x1000, 0x1001, 0x1018 };

    for (size_t i = 0; i < sizeof mandatory / sizeof mandatory[0]; i++) {
        if (!dcf_has_object(self->dcf, mandatory[i]))
            dcf_tell(self->report, DCF_RULE_MANDATORY_OBJECT, 0,
                     "an object %04Xh expected in every device, it is missing", mandatory[i]);
    }
}

/* A key that is missing has been told. */
static void check_pdo_count(struct dcf_builder *self, const struct dcf_key *key, uint16_t first,
                            unsigned announced)
{
    unsigned count = 0;

    if (!key)
        return;
    for (unsigned i = 0; i < PDOS_MAX; i++)
        count += dcf_has_object(self->dcf, (uint16_t)(first + i));
    if (count != announced)
        dcf_tell(self->report, DCF_RULE_PDO_COUNT, key->line,
                 "[DeviceInfo] %s: %u expected (so many communication parameters are there), "
                 "it is %u",
                 dcf_show(key->name).text, count, announced);
}

void dcf_check_lists(struct dcf_builder *self)
{
    struct place *places = calloc((size_t)UINT16_MAX + 1, sizeof *places);
    struct dcf_section *info = dcf_text_find(&self->text, DCF_SECTION_DEVICE_INFO);

    if (!places) {
        self->no_memory = true;
        return;
    }
    for (size_t i = 0; i < self->text.section_count; i++) {
        const struct dcf_section *section = &self->text.sections[i];

        if (section->kind == DCF_SECTION_OBJECT)
            places[section->index].section_line = section->line;
    }
    for (size_t i = 0; i < LIST_COUNT; i++)
        check_list(self, &lists[i], places);
    check_sections(self, places);
    free(places);
    check_mandatory(self);
    if (info) {
        check_pdo_count(self, dcf_section_find(info, "NrOfRXPDO"), 0x1400, self->dcf->rx_pdos);
        check_pdo_count(self, dcf_section_find(info, "NrOfTXPDO"), 0x1800, self->dcf->tx_pdos);
    }
}
