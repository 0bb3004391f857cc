#include "audit_plant.h"

#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[SUITE_PATH_SIZE];

/* Every device has these. */
static const char beginning[] =
    "[FileInfo]\nFileName=a.dcf\nFileVersion=1\nFileRevision=0\nEDSVersion=4.0\n"
    "[DeviceInfo]\nVendorName=V\nProductName=P\nBaudRate_250=1\nBaudRate_500=1\nGranularity=8\n"
    "[DummyUsage]\nDummy0005=1\n[MandatoryObjects]\nSupportedObjects=0\n"
    "[OptionalObjects]\nSupportedObjects=0\n[ManufacturerObjects]\nSupportedObjects=0\n" //
    VAR("1000", "7", "ro", IS("0x191"))                                                  //
    VAR("1001", "5", "ro", IS("0"))                                                      //
    OBJECT("1018", "4")                                                                  //
    VAR("1018sub1", "7", "ro", IS("0x11"))                                               //
    VAR("1018sub2", "7", "ro", IS("0x22"))                                               //
    VAR("1018sub3", "7", "ro", IS("0x33"));

void audit_plant_set_up(void)
{
    suite_temporary("audit", folder);
    ck_assert_ptr_nonnull(mkdtemp(folder));
    ck_assert_int_eq(chdir(folder), 0);
}

void audit_plant_tear_down(void)
{
    char command[sizeof folder + 16];

    snprintf(command, sizeof command, "rm -r %s", folder);
    ck_assert_int_eq(system(command), 0);
}

void audit_plant_write(const char *name, const char *text)
{
    FILE *file = fopen(name, "w");

    ck_assert_ptr_nonnull(file);
    ck_assert_int_ge(fputs(text, file), 0);
    ck_assert_int_eq(fclose(file), 0);
}

static void write_node(FILE *xml, unsigned id, const char *elements, const char *objects)
{
    char name[16];

    if (!elements)
        return;
    fprintf(xml, "<Node_Instance>\n<Node_Id>%u</Node_Id>\n%s", id, elements);
    if (objects) {
        FILE *dcf;

        snprintf(name, sizeof name, "%u.dcf", id);
        dcf = fopen(name, "w");
        ck_assert_ptr_nonnull(dcf);
        fprintf(dcf, "%s%s", beginning, objects);
        ck_assert_int_eq(fclose(dcf), 0);
        fprintf(xml, "<DCF_File>%s</DCF_File>\n", name);
    }
    fputs("</Node_Instance>\n", xml);
}

void audit_plant_write_case(const struct audit_case *self)
{
    FILE *xml = fopen("n.xml", "w");

    ck_assert_ptr_nonnull(xml);
    fprintf(xml,
            "<CANopen_Manager>\n<Manager_Instance>\n<Net_No>0</Net_No>\n<Baudrate>500</Baudrate>\n"
            "%s",
            self->network ? self->network : "");
    write_node(xml, 5, self->xml5, self->dcf5);
    write_node(xml, 6, self->xml6, self->dcf6);
    fputs("</Manager_Instance>\n</CANopen_Manager>\n", xml);
    ck_assert_int_eq(fclose(xml), 0);
}

static void append(char *text, size_t size, const char *between, const char *more)
{
    const size_t used = strlen(text);

    snprintf(text + used, size - used, "%s%s", used > 0 ? between : "", more);
}

static bool is_of_networks(const struct co_rule *rule)
{
    for (size_t i = 0; i < AUDIT_RULE_COUNT; i++)
        if (rule == &audit_rules[i])
            return true;
    return false;
}

static void take(void *context, const struct co_message *message)
{
    struct audit_told *self = context;
    const struct co_rule *rule = message->rule;
    char line[CO_REPORT_TEXT_SIZE + 64];

    if (rule ? !is_of_networks(rule) : message->severity != CO_ERROR)
        return; /* of the readers of the files */
    append(self->rules, sizeof self->rules, ", ", rule ? rule->name : "none");
    snprintf(line, sizeof line, "%s [%s]\n", message->text, rule ? rule->name : "none");
    append(self->text, sizeof self->text, "", line);
}

void audit_told_init(struct audit_told *self)
{
    *self = (struct audit_told){ .report = { .sink = take, .context = self } };
}

void audit_plant_run(struct audit_told *told)
{
    struct audit audit = { .xml_path = "n.xml", .report = &told->report };

    if (!audit_open(&audit))
        return;
    ck_assert(audit_run(&audit));
    audit_close(&audit);
}

void audit_plant_check(const struct audit_case *self)
{
    static struct audit_told told;

    audit_told_init(&told);
    audit_plant_write_case(self);
    audit_plant_run(&told);
    ck_assert_msg(strcmp(told.rules, self->rules) == 0, "expected \"%s\", got \"%s\":\n%s",
                  self->rules, told.rules, told.text);
    ck_assert_msg(!self->text || strstr(told.text, self->text), "expected \"%s\" in:\n%s",
                  self->text, told.text);
}
