#!/usr/bin/env python3
"""Normal boots of two processes on a bus: the log equals the expected one, frame for frame.

The expected logs are those of the boots in virtual time (tests/scenario/test_boot_normal.c): the
same network, nodes 5 and 6, has to say the same here, with device files and real time. Time-outs
and delays are longer than the defaults, they are not to be seen in the log and a slow machine must
not change it. The comparison, what it leaves out, and why: wire.py.
"""
import plant
import wire
from devices import UNSIGNED8, Entry, Record, dcf, network, node, standard

PATIENT = {"SDO_Timeout": 20000}
DELAY = {"Boot_Delay": 1000}


class Boot(plant.PlantTest):
    def setUp(self):
        super().setUp()
        plain = self.write("five.dcf", dcf(5, standard(5)))
        io = Record(0x6200, [Entry(0x6200, UNSIGNED8, 0, "rw", "0x55")])
        self.write("six.dcf", dcf(6, [*standard(6, heartbeat=500), io]))
        self.plain = plain

    def nodes(self, files):
        identity = {"Device_Type_Identification": "0x20192", "Vendor_Identification": "0x29A",
                    "Serial_Number": 6, "Consumer_Heartbeat_Time": 30000}
        return [node(5, **PATIENT), node(6, **identity, **files, **PATIENT)]

    def boot_and_compare(self, text, log):
        xml = self.write("network.xml", text)
        sim = self.start_sim("--node", 5, self.plain, "--node", 6, self.folder / "six.dcf",
                             "--without", 9, xml)
        dump = self.dump()
        boot = self.boot("--once", xml)
        dump.wait_for("706#05")
        self.assert_stopped(sim)
        frames = dump.end()
        expected = wire.frames_of((plant.DATA / "wire" / log).read_text(encoding="utf-8"))
        found = wire.difference(expected, frames)
        self.assertIsNone(found, f"{log}: {found}\n" + "\n".join(frames) + boot.story())
        plant.say(f"{len(frames)} frames as in {log}")

    def test_defaults(self):
        """all defaults"""
        self.boot_and_compare(network(self.nodes({"DCF_File": "six.dcf"}), **DELAY),
                              "boot_defaults.log")

    def test_start_all(self):
        """NMT_Start_All"""
        self.boot_and_compare(
            network(self.nodes({"DCF_File": "six.dcf"}), NMT_Start_All="TRUE", **DELAY),
            "boot_start_all.log")

    def test_absent(self):
        """one absent optional node"""
        nodes = [*self.nodes({"DCF_File": "six.dcf"}), node(9)]
        self.boot_and_compare(network(nodes, NMT_Start_All="TRUE", **DELAY), "boot_absent.log")

    def convert(self):
        converted = self.run_command([plant.TOOLS / "dcf2ccf", self.folder / "six.dcf",
                                      self.folder / "six.ccf"])
        self.assertEqual(converted.code, 0, converted.story())

    def test_ccf(self):
        """the configuration of dcf2ccf as CCF_File gives the same log"""
        self.convert()
        self.boot_and_compare(network(self.nodes({"CCF_File": "six.ccf"}), **DELAY),
                              "boot_defaults.log")

    def test_ccf_start_all(self):
        """CCF_File and NMT_Start_All"""
        self.convert()
        self.boot_and_compare(
            network(self.nodes({"CCF_File": "six.ccf"}), NMT_Start_All="TRUE", **DELAY),
            "boot_start_all.log")


if __name__ == "__main__":
    plant.main()
