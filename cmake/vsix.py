"""vsix.py OUT: the VS Code extension as a package, `code --install-extension OUT/sysid-VERSION.vsix`. Needs npm and its registry."""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[1]

TYPES = """<?xml version="1.0" encoding="utf-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">{types}</Types>
"""
MANIFEST = """<?xml version="1.0" encoding="utf-8"?>
<PackageManifest Version="2.0.0" xmlns="http://schemas.microsoft.com/developer/vsx-schema/2011">
  <Metadata>
    <Identity Language="en-US" Id="{name}" Version="{version}" Publisher="{publisher}"/>
    <DisplayName>{displayName}</DisplayName>
    <Description xml:space="preserve">{description}</Description>
    <Categories>{categories}</Categories>
    <Properties><Property Id="Microsoft.VisualStudio.Code.Engine" Value="{engine}"/></Properties>
    <License>extension/LICENSE</License>
  </Metadata>
  <Installation><InstallationTarget Id="Microsoft.VisualStudio.Code"/></Installation>
  <Dependencies/>
  <Assets><Asset Type="Microsoft.VisualStudio.Code.Manifest" Path="extension/package.json" Addressable="true"/></Assets>
</PackageManifest>
"""


def main(out: str) -> None:
    about = json.loads((ROOT / "grammar/vscode/package.json").read_text())
    with tempfile.TemporaryDirectory() as folder:
        extension = pathlib.Path(folder)
        for path in (*(ROOT / "grammar/vscode").iterdir(), ROOT / "grammar/sysid.tmLanguage.json", ROOT / "grammar/language-configuration.json", ROOT / "LICENSE"):
            shutil.copy(path, extension)
        command = ["npm", "install", "--omit=dev", "--no-audit", "--no-fund", "--no-package-lock", "--ignore-scripts"]
        subprocess.run(command, cwd=extension, check=True, stdout=subprocess.DEVNULL)
        files = [path for path in sorted(extension.rglob("*")) if path.is_file() and ".bin" not in path.parts]
        endings = sorted({path.suffix[1:] for path in files if path.suffix} | {"vsixmanifest"})
        types = "".join(f'<Default Extension="{each}" ContentType="{"text/xml" if each == "vsixmanifest" else "application/octet-stream"}"/>' for each in endings)
        bare = "".join(
            f'<Override PartName="/extension/{path.relative_to(extension)}" ContentType="text/plain"/>' for path in files if not path.suffix
        )
        target = pathlib.Path(out, f"{about['name']}-{about['version']}.vsix")
        target.parent.mkdir(parents=True, exist_ok=True)
        known = {**about, "categories": ",".join(about["categories"]), "engine": about["engines"]["vscode"]}
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as package:
            package.writestr("[Content_Types].xml", TYPES.format(types=types + bare))
            package.writestr("extension.vsixmanifest", MANIFEST.format(**known))
            for path in files:
                package.write(path, f"extension/{path.relative_to(extension)}")
        print(target)


main(sys.argv[1])
