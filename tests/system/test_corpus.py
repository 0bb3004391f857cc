#!/usr/bin/env python3
"""Real devices: simulated from the files of their vendors, configured, booted as one network.

The corpus of EDS and DCF files is no part of the project; without it this is reported as not run.
"""
import unittest

import eds
import plant
from devices import network, node

# One device each of many vendors, with different profiles.
DEVICES = [
    "christiansandberg+canopen/cog.eds",
    "starnus-software+ros2_canopen/CL4-E-1-12.eds",
    "hellantos+trinamic_pd42_can/TMCM-1270~7dca3c92.eds",
    "davidsenoner+emec-drv-canopen-tester/emecdrv5_rev09.eds",
    "KIM-HC+canopen_linux/elmo~2f34c0e5.eds",
    "beremiz+beremiz/PEAK MicroMod~20d37ba6.eds",
    "ngblume+python-canopen-tests/pe552c_can_io_v01000007.eds",
    "CANopenNode+CANopenEditor/demo_sensor.eds",
    "ngblume+python-canopen-tests/SimNode~8eca9489.eds",
    "rtlabs-com+c-open/slave.eds",
    "ros-industrial+ros_canopen/technosoft~1e36fbe8.eds",
    "ros-industrial+ros_canopen/PRL120~5b94e33c.eds",
    "b-robotized+diff_canopen_system/EDS_20014_Standard_CANopen_V212_01.eds",
    "beremiz+canfestival/DS401_Slave_Gui~9c4e3313.eds",
    "oresat+CANopen-monitor/GPS_OD.eds",
    "b-robotized+diff_canopen_system/sample.eds",
    "vsi5004+RDJ-ROS/servo_node.eds",
    "ros-industrial+ros_canopen/ISD860.eds",
    "ros-industrial+ros_canopen/Schunk_0_63.eds",
    "CANopenNode+CANopenEditor/demo_drive.eds",
    "CANopenNode+CANopenNode/CANopen_Sensor_s32k144.eds",
    "CANopenNode+CANopenNode/IO~4697e55b.eds",
    "ros-industrial+ros_canopen/cia402_slave~080ed435.eds",
    "ros-industrial+ros_canopen/simple~00e65803.eds",
]
# DCF files of vendors, as they are; their node-IDs and bit rates are their own.
CONFIGURED = [
    "ipa320+cob_robots/Elmo~2aa6d56c.dcf",
    "ros-industrial+ros_canopen/Schunk_0_63~6345efef.dcf",
    "PilzDE+pilz_robots/prbt_0_1~5d404304.dcf",
    "ros-industrial+ros_canopen/ISD860.dcf",
    "ros-industrial+ros_canopen/Whistle Gold V002~0b1c6639.dcf",
    "oresat+CANopen-monitor/battery.dcf",
    "lely-industries+lely-core/co-nmt-slave.dcf",
]
PER_TYPE = 2  # entries of each data type that are configured
BAUDRATE = 500
HEARTBEAT = 1000
PATIENT = {"SDO_Timeout": 20000}
# Identity, state, saving and restoring, programs.
NO_CONFIGURATION = (0x1000, 0x1001, 0x1010, 0x1011, 0x1018, 0x1200, 0x1F50, 0x1F51)
PATTERN = 0x5A5A5A5A5A5A5A5A


def chosen_value(entry):
    """A text for ParameterValue, or None."""
    if entry.kind == eds.VISIBLE_STRING:
        return "set by a system test"
    limits = entry.limits()
    if limits is None or entry.kind == eds.BOOLEAN:
        return None
    if entry.kind in (eds.REAL32, eds.REAL64):
        return "-2.5"
    if entry.kind in eds.SIGNED:
        return str(max(limits[0], min(limits[1], -2)))
    if entry.kind in eds.UNSIGNED:
        return hex(max(limits[0], min(limits[1], PATTERN % (1 << eds.UNSIGNED[entry.kind]))))
    return None


def is_application(entry):
    """What a device lets one write without further rules: nothing of communication, no counts."""
    counts = entry.sub == 0 and entry.keys.get("parametername", "").lower().startswith(
        ("number", "highest", "max sub", "length", "nr"))
    return (0x2000 <= entry.index < 0xA000 and entry.access in eds.WRITABLE and not counts
            and "objflags" not in entry.keys)


def is_configuration(entry):
    """What a ParameterValue is written to."""
    return (entry.access in eds.WRITABLE and entry.index not in NO_CONFIGURATION
            and not (eds.number(entry.keys.get("objflags", "")) or 0) & 1)


def is_mapped(device, entry):
    """False for an object that the file's own count leaves out of a mapping."""
    if not (0x1600 <= entry.index < 0x1800 or 0x1A00 <= entry.index < 0x1C00):
        return True
    count = device.entries[(entry.index, 0)].keys.get("parametervalue")
    return not count or entry.sub <= eds.number(count)


def application_values(device):
    values, count = {}, {}
    for entry in device.entries.values():
        has_subs = (entry.index, 1) in device.entries
        text = chosen_value(entry) if is_application(entry) else None
        if text is None or (entry.sub == 0 and has_subs) or count.get(entry.kind, 0) == PER_TYPE:
            continue
        count[entry.kind] = count.get(entry.kind, 0) + 1
        values[entry] = text
    return values


def mapping_values(device):
    """A first TPDO with one object in it, where the device lets one choose."""
    number, first = device.entries.get((0x1A00, 0)), device.entries.get((0x1A00, 1))
    if not (number and first and {number.access, first.access} <= set(eds.WRITABLE)):
        return {}
    for entry in device.entries.values():
        if (entry.keys.get("pdomapping") == "1" and entry.access in ("ro", "rw", "rwr")
                and entry.kind in (*eds.UNSIGNED, *eds.SIGNED) and entry.index >= 0x2000):
            mapped = entry.index << 16 | entry.sub << 8 | eds.BITS[entry.kind]
            return {number: "1", first: f"0x{mapped:08X}"}
    return {}


def communication_values(device):
    heartbeat = device.entries.get((0x1017, 0))
    transmission = device.entries.get((0x1800, 2))
    values = {}
    if heartbeat and heartbeat.access in eds.WRITABLE:
        values[heartbeat] = str(HEARTBEAT)
    if transmission and transmission.access in eds.WRITABLE and not transmission.limits() == (0, 0):
        values[transmission] = "1"
    return values


def configuration(device):
    return {**application_values(device), **communication_values(device),
            **mapping_values(device)}


def identity(device, node_id):
    """Elements of the XML that compare what the file says."""
    result = {}
    for name, place in (("Device_Type_Identification", (0x1000, 0)),
                        ("Vendor_Identification", (0x1018, 1)), ("Product_Code", (0x1018, 2))):
        entry = device.entries.get(place)
        if entry and entry.default(node_id):
            result[name] = entry.default(node_id)
    return result


@unittest.skipUnless(plant.CORPUS.is_dir(), f"no corpus in {plant.CORPUS}")
class RealDevices(plant.PlantTest):
    def assert_written(self, frames, node_id, expected, name):
        """Each value has been written, the last time with these bytes."""
        last = {(index, sub): data for index, sub, data in eds.downloads(frames, node_id)}
        for (index, sub), data in expected.items():
            with self.subTest(f"{name} {index:04X}:{sub:02X}"):
                self.assertEqual(last.get((index, sub), b"").hex(), data.hex())

    def boot_all(self, xml, simulated):
        arguments = [word for node_id, path in simulated.items()
                     for word in ("--node", node_id, path)]
        sim = self.start_sim(*arguments)
        dump = self.dump()
        boot = self.boot("--once", "--all", xml)
        self.assert_stopped(sim)
        self.assertIn(f"{len(simulated)} of {len(simulated)} nodes booted", boot.out.text())
        return dump.end()

    def test_configured(self):
        """devices of many vendors, each with values of its types, a PDO and a heartbeat"""
        devices = {n: eds.File(plant.CORPUS / name) for n, name in enumerate(DEVICES, 1)}
        values = {n: configuration(device) for n, device in devices.items()}
        nodes = []
        for n, device in devices.items():
            name = f"{n}.dcf"
            self.folder.joinpath(name).write_text(device.configured(values[n], n, BAUDRATE),
                                                  encoding="latin-1")
            beats = any(entry.index == 0x1017 for entry in values[n])
            watch = {"Consumer_Heartbeat_Time": 30000} if beats else {}
            nodes.append(node(n, DCF_File=name, **identity(device, n), **watch, **PATIENT))
        xml = self.write("network.xml", network(nodes, Baudrate=BAUDRATE))
        frames = self.boot_all(xml, {n: device.path for n, device in devices.items()})
        for n, device in devices.items():
            expected = {(entry.index, entry.sub): eds.encode(entry.kind, text, n)
                        for entry, text in values[n].items()}
            self.assert_written(frames, n, expected, device.path.name)
            self.assertGreater(len(expected), 0, device.path)
            kinds = sorted({entry.kind for entry in values[n]})
            plant.say(f"node {n}: {device.vendor()}, {device.path.name}: {len(expected)} values, "
                      f"types {kinds}, mapping: {(0x1A00, 1) in expected}")
        self.assertGreaterEqual(len(devices), 20)
        self.assertGreaterEqual(len({device.vendor() for device in devices.values()}), 10)

    def test_vendors_dcf(self):
        """DCF files of vendors as they are: simulated from them, configured by them"""
        for name in CONFIGURED:
            with self.subTest(name):
                self.boot_dcf(eds.File(plant.CORPUS / name))

    def boot_dcf(self, device):
        commissioning = device.commissioning()
        node_id = eds.number(commissioning.get("nodeid", "")) or 5
        baudrate = eds.number(commissioning.get("baudrate", "")) or BAUDRATE
        xml = self.write("network.xml", network(
            [node(node_id, DCF_File=device.path, **identity(device, node_id), **PATIENT)],
            Baudrate=baudrate, Manager_Node_Id=127 if node_id != 127 else 126))
        frames = self.boot_all(xml, {node_id: device.path})
        expected = {
            (entry.index, entry.sub): eds.encode(entry.kind, entry.keys["parametervalue"], node_id)
            for entry in device.entries.values()
            if is_configuration(entry) and is_mapped(device, entry)
            and entry.keys.get("parametervalue")}
        self.assert_written(frames, node_id, expected, device.path.name)
        written = eds.downloads(frames, node_id)
        plant.say(f"{device.vendor()}, {device.path.name}: node {node_id}, {baudrate} kbit/s, "
                  f"{len(written)} writes, {len(expected)} compared")


@unittest.skipUnless(plant.CORPUS.is_dir(), f"no corpus in {plant.CORPUS}")
class EachFile(plant.PlantTest):
    def judge(self, name):
        """'' simulated, else what it is refused with."""
        process = self.start([*plant.WRAP, plant.MCANOPEN, "sim", "-q", "--bus", self.bus.name,
                              "--node", 5, name], plant.CORPUS)
        process.wait_until(lambda lines: lines or process.err.lines, "a word")
        if process.out.lines:
            self.assert_stopped(process)
            self.assertEqual(process.err.text(), "", process.story())
        else:
            self.assertEqual(process.wait(), 2, process.story())
            self.assertRegex(process.err.lines[0], r"^[^:]*:\d+: error: ", process.story())
            self.assertTrue(process.err.text().startswith(f"{name}:"), process.story())
        process.close()
        return process.err.text()

    def test_sim(self):
        """mcanopen sim --node takes each file, or refuses it with its name and a line"""
        names = sorted(str(path.relative_to(plant.CORPUS)) for path in plant.CORPUS.rglob("*")
                       if path.suffix.lower() in (".eds", ".dcf"))
        refused = 0
        for name in names:
            with self.subTest(name):
                message = self.judge(name)
                refused += bool(message)
                if message:
                    plant.say(f"refused: {message.splitlines()[0]}")
        plant.say(f"{len(names)} files, {refused} refused")
        self.assertGreater(len(names), 0)


if __name__ == "__main__":
    plant.main()
