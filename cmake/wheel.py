"""wheel.py INSTALLED VERSION LICENSE OUT MODULE...: a wheel of the installed Python module, with nothing but Python's own library.

INSTALLED: a folder that holds the package `sysid`. MODULE: a library that the engine opens. The wheel is written into OUT.
"""

import base64
import hashlib
import pathlib
import sys
import sysconfig
import zipfile


def record_line(name: str, content: bytes) -> str:
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def main(installed: str, version: str, license: str, out: str, *modules: str) -> None:
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    tag = f"{python}-{python}-{platform}"
    package = pathlib.Path(installed, "sysid")
    files = {f"sysid/{path.relative_to(package)}": path for path in sorted(package.rglob("*")) if path.is_file() and path.suffix != ".pyc"}
    files |= {f"sysid/{pathlib.Path(module).name}": pathlib.Path(module) for module in modules}
    info = f"sysid-{version}.dist-info"
    made = {
        f"{info}/METADATA": (
            f"Metadata-Version: 2.1\nName: sysid\nVersion: {version}\n"
            "Summary: Bayesian identification of nonlinear systems, from equations written as on paper\n"
            "Requires-Python: >=3.11,<3.12\nRequires-Dist: numpy\n"
            "Provides-Extra: results\nRequires-Dist: xarray; extra == 'results'\nRequires-Dist: pandas; extra == 'results'\n"
            "Provides-Extra: notebook\nRequires-Dist: ipython; extra == 'notebook'\n"
        ).encode(),
        f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: sysid\nRoot-Is-Purelib: false\nTag: {tag}\n".encode(),
        f"{info}/LICENSE": pathlib.Path(license).read_bytes(),
    }
    target = pathlib.Path(out, f"sysid-{version}-{tag}.whl")
    target.parent.mkdir(parents=True, exist_ok=True)
    record = ""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, content in [*((name, path.read_bytes()) for name, path in files.items()), *made.items()]:
            entry = zipfile.ZipInfo(name)  # of 1980: the same files make the same wheel
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.endswith(".so") else 0o644) << 16
            wheel.writestr(entry, content)
            record += record_line(name, content)
        entry = zipfile.ZipInfo(f"{info}/RECORD")
        entry.external_attr = 0o644 << 16
        wheel.writestr(entry, record + f"{info}/RECORD,,\n")
    print(target)


main(*sys.argv[1:])
