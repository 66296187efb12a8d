"""The module as it is installed: in a prefix that is moved, with the program's compiler of machine code in reach."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

PROGRAM = """
import sysid
print(sysid.__file__)
model = sysid.load("duffing.sysid")
for seed in range(5):  # long enough for machine code to pay
    model.log_density(model.sample_prior(20000, seed=seed))
print(any("sysid_native.so" in line for line in open("/proc/self/maps")))
"""


class Installed(unittest.TestCase):
    def test_in_a_moved_prefix(self):
        with tempfile.TemporaryDirectory() as folder:
            first, moved = pathlib.Path(folder, "first"), pathlib.Path(folder, "moved")
            for component in ("program", "python"):
                command = ["cmake", "--install", os.environ["SYSID_BUILD_DIR"], "--component", component, "--prefix", str(first)]
                subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            first.rename(moved)
            for name in ("duffing.sysid", "duffing_1pct.csv"):
                shutil.copy(ROOT / "models/duffing" / name, folder)
            path = moved / "lib/python3/dist-packages"
            said = subprocess.run(
                ["/usr/bin/python3", "-c", PROGRAM], cwd=folder, env={"PYTHONPATH": str(path)}, capture_output=True, text=True
            )
            self.assertEqual(said.stdout.splitlines(), [str(path / "sysid/__init__.py"), "True"], said.stderr)
            self.assertTrue((path / "sysid/py.typed").exists())
            self.assertTrue((path / "sysid/_engine.pyi").exists())


if __name__ == "__main__":
    unittest.main()
