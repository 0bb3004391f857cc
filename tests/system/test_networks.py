#!/usr/bin/env python3
"""Several networks in one file: mcanopen boot brings each up on its own, and tells them apart."""
import plant
from devices import dcf, elements, node, standard

HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n<CANopen_Manager>\n'


def instance(number, bus, nodes, **values):
    values = {"Net_No": number, "Interface": bus.name, "Baudrate": 1000, "Boot_Delay": 200,
              **values}
    return ("  <Manager_Instance>\n" + elements(values, "    ") + "".join(nodes)
            + "  </Manager_Instance>\n")


class Networks(plant.PlantTest):
    """Node 5 in both networks; in the second one also node 6, which is mandatory."""

    def setUp(self):
        super().setUp()
        self.second = plant.Bus()
        self.buses.append(self.second)
        self.plain = self.write("five.dcf", dcf(5, standard(5)))
        self.six = self.write("six.dcf", dcf(6, standard(6)))

    def write_network(self, **values):
        mandatory = node(6, Name="pump", NMT_Mandatory_Slave="TRUE", **values)
        return self.write("network.xml", HEAD
                          + instance(0, self.bus, [node(5, Name="panel")], Name="hall")
                          + instance(7, self.second, [node(5), mandatory])
                          + "</CANopen_Manager>\n")

    def start_devices(self):
        self.start_sim("--node", 5, self.plain)
        self.start_sim("--node", 5, self.plain, "--node", 6, self.six, bus=self.second)

    def rows(self, boot):
        """The table of each network: {heading: [(node, its state)]}."""
        tables, heading = {}, None
        for line in boot.out.lines:
            if line.startswith("network ") and " on " in line:
                heading = line
            elif heading and line[:4].strip().isdigit() and "  " in line[4:]:
                state = next(w for w in line.split() if w in ("OPERATIONAL", "PRE-OPERATIONAL",
                                                              "offline"))
                tables.setdefault(heading, []).append((int(line.split()[0]), state))
        return tables

    def test_both_up(self):
        """both come up: a table for each"""
        self.start_devices()
        boot = self.boot("--once", "--all", self.write_network())
        self.assertEqual(self.rows(boot), {
            f'network 0 "hall" on {self.bus.name}': [(5, "OPERATIONAL")],
            f"network 7 on {self.second.name}": [(5, "OPERATIONAL"), (6, "OPERATIONAL")]},
            boot.story())
        self.assertIn("hall: network is up: 1 of 1 nodes booted", boot.out.text())
        self.assertIn(f"{self.second.name}: network is up: 2 of 2 nodes booted", boot.out.text())

    def test_one_halted(self):
        """a wrong device halts its network; the other one comes up first, whatever is first"""
        self.start_devices()
        boot = self.boot("--once", self.write_network(Vendor_Identification="0x17A"), code=1)
        tables = self.rows(boot)
        self.assertEqual(tables[f'network 0 "hall" on {self.bus.name}'], [(5, "OPERATIONAL")],
                         boot.story())
        self.assertEqual(tables[f"network 7 on {self.second.name}"][1],
                         (6, "PRE-OPERATIONAL"), boot.story())
        self.assertIn('network not started: mandatory node 6 "pump" is missing', boot.out.text())
        self.assertIn("boot error D: 1018h:01 vendor-ID is 0000029Ah, configuration expects "
                      "0000017Ah", boot.out.text())


if __name__ == "__main__":
    plant.main()
