"""The wheel: built from the build without a network, installed by pip, imported elsewhere."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]

PROGRAM = """
import importlib.metadata, sysid
print(sysid.__file__)
print(importlib.metadata.version("sysid") == sysid.__version__)
model = sysid.load("duffing.sysid")
for seed in range(5):  # long enough for machine code to pay
    model.log_density(model.sample_prior(20000, seed=seed))
print(any("sysid/sysid_native.so" in line for line in open("/proc/self/maps")))
"""


class Wheel(unittest.TestCase):
    def test_installs_and_imports(self):
        with tempfile.TemporaryDirectory() as folder:
            build = os.environ["SYSID_BUILD_DIR"]
            said = subprocess.run(["cmake", "--build", build, "--target", "wheel"], capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
            (wheel,) = pathlib.Path(build, "wheel").glob("*.whl")
            self.assertRegex(wheel.name, r"^sysid-\d+\.\d+\.\d+-cp311-cp311-linux_x86_64\.whl$")
            # pip checks the sums of RECORD only for some files: all are to be in it.
            with zipfile.ZipFile(wheel) as content:
                (record,) = (name for name in content.namelist() if name.endswith("/RECORD"))
                listed = [line.split(",")[0] for line in content.read(record).decode().splitlines()]
                self.assertEqual(sorted(listed), sorted(content.namelist()))
                self.assertIn("sysid/py.typed", listed)
            target = pathlib.Path(folder, "target")
            command = ["/usr/bin/python3", "-m", "pip", "install", "--no-index", "--no-deps", "--no-compile", "--target", str(target), str(wheel)]
            said = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PIP_DISABLE_PIP_VERSION_CHECK": "1"})
            self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
            for name in ("duffing.sysid", "duffing_1pct.csv"):
                shutil.copy(ROOT / "models/duffing" / name, folder)
            said = subprocess.run(["/usr/bin/python3", "-c", PROGRAM], cwd=folder, env={"PYTHONPATH": str(target)}, capture_output=True, text=True)
            self.assertEqual(said.stdout.splitlines(), [str(target / "sysid/__init__.py"), "True", "True"], said.stderr)


if __name__ == "__main__":
    unittest.main()
