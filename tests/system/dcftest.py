"""What the tests of dcftest share."""
import subprocess

import plant
from devices import UNSIGNED8, UNSIGNED16, Entry, dcf, standard

DCFTEST = str(plant.TOOLS / "dcftest")
CLEAN, ERRORS, TROUBLE, NO_BUS = 0, 1, 2, 3


def device(node=5, **values):
    """A file without a fault."""
    drive = [Entry(0x6040, UNSIGNED16, 0, "rw"), Entry(0x6041, UNSIGNED16, 0, "ro")]
    return dcf(node, [*standard(5), Entry(0x2000, UNSIGNED8, 0, "rw", values.get("value")), *drive])


def with_error():
    return device(value=256)


def with_warning():
    return device().replace("[DummyUsage]", "# a comment\n[DummyUsage]")


class DcftestTest(plant.PlantTest):
    def run_tool(self, *arguments, **options):
        words = [*plant.WRAP, DCFTEST, *map(str, arguments)]
        done = subprocess.run(words, capture_output=True, cwd=self.folder, timeout=plant.LIMIT,
                              check=False, **options)
        done.out, done.err = (text.decode(errors="surrogateescape")
                              for text in (done.stdout, done.stderr))
        return done

    def check(self, code, *arguments, **options):
        """The lines of stdout; the exit code must be this one."""
        done = self.run_tool(*arguments, **options)
        self.assertEqual(done.returncode, code, done.out + done.err)
        return done.out.splitlines()

    def refuse(self, text, *arguments):
        """Wrong usage: nothing on stdout."""
        done = self.run_tool(*arguments)
        self.assertEqual((done.returncode, done.out), (TROUBLE, ""))
        self.assertIn(text, done.err)
