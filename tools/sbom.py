#!/usr/bin/env python3
"""sbom.py PROGRAM [--version V] [-o FILE]: what a built program consists of, as SPDX 2.3 JSON: the Debian packages that it loads, those whose
headers are compiled into it, and the npm packages of the page that it holds. The same program and packages give the same bytes; the time is
SOURCE_DATE_EPOCH, or that of the last commit."""
import argparse
import base64
import datetime
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
HEADERS = ("libeigen3-dev", "libexpected-dev", "libcli11-dev", "nlohmann-json3-dev")  # nothing of these is loaded


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True).stdout


def commit_time():
    stamp = os.environ.get("SOURCE_DATE_EPOCH") or run("git", "-C", ROOT, "log", "-1", "--format=%ct").strip()
    return datetime.datetime.fromtimestamp(int(stamp), datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def loaded(program):
    """The files of the shared libraries that a program loads, links followed."""
    found = []
    for line in run("ldd", program).splitlines():
        words = line.split()
        if "=>" in words and words[2] == "not":
            raise SystemExit(f"sbom.py: {program}: {words[0]} is not installed")
        path = words[2] if "=>" in words else words[0]
        if path.startswith("/"):
            found.append(Path(path).resolve())
    return found


def package_of(file):
    """The Debian package that a library comes from; in the two spellings that a merged /usr has."""
    spellings = [str(file), str(file).removeprefix("/usr")]
    for spelling in spellings + ["/usr" + str(file)]:
        asked = subprocess.run(["dpkg-query", "-S", spelling], capture_output=True, text=True, check=False)
        if asked.returncode == 0:
            return asked.stdout.split(": ")[0].split(":")[0]
    raise SystemExit(f"sbom.py: no Debian package has {file}")


def debian_packages(program):
    names = sorted({package_of(file) for file in loaded(program)} | set(HEADERS))
    lines = run("dpkg-query", "-W", "-f", "${Package}\t${Version}\t${Architecture}\n", *names).splitlines()
    for name, version, architecture in sorted(line.split("\t") for line in lines):
        yield {"name": name, "SPDXID": f"SPDXRef-deb-{spdx_id(name)}", "versionInfo": version, "downloadLocation": "NOASSERTION",
               "filesAnalyzed": False, "licenseConcluded": "NOASSERTION", "licenseDeclared": "NOASSERTION", "copyrightText": "NOASSERTION",
               "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                 "referenceLocator": f"pkg:deb/debian/{name}@{version}?arch={architecture}"}]}


def npm_packages():
    """Those that the page is made of; what only builds or tests it is left out."""
    lock = json.loads((ROOT / "viewer" / "package-lock.json").read_text())
    for path, package in sorted(lock["packages"].items()):
        if not path or package.get("dev") or package.get("optional"):
            continue
        name = path.split("node_modules/")[-1]
        algorithm, digest = package["integrity"].split("-", 1)
        yield {"name": name, "SPDXID": f"SPDXRef-npm-{spdx_id(name)}", "versionInfo": package["version"],
               "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "licenseConcluded": "NOASSERTION",
               "licenseDeclared": package.get("license", "NOASSERTION"), "copyrightText": "NOASSERTION",
               "checksums": [{"algorithm": algorithm.upper(), "checksumValue": base64.b64decode(digest).hex()}],
               "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                 "referenceLocator": f"pkg:npm/{name.replace('@', '%40')}@{package['version']}"}]}


def spdx_id(name):
    return "".join(letter if letter.isalnum() or letter in ".-" else "-" for letter in name)


def describe(program, version):
    digest = hashlib.sha256(Path(program).read_bytes()).hexdigest()
    own = {"name": "snug", "SPDXID": "SPDXRef-snug", "versionInfo": version, "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
           "licenseConcluded": "NOASSERTION", "licenseDeclared": "Apache-2.0", "copyrightText": "NOASSERTION",
           "checksums": [{"algorithm": "SHA256", "checksumValue": digest}]}
    debian, npm = list(debian_packages(program)), list(npm_packages())
    relations = [("SPDXRef-DOCUMENT", "DESCRIBES", "SPDXRef-snug")]
    relations += [("SPDXRef-snug", "STATIC_LINK" if one["name"] in HEADERS else "DYNAMIC_LINK", one["SPDXID"]) for one in debian]
    relations += [("SPDXRef-snug", "CONTAINS", one["SPDXID"]) for one in npm]
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"snug-{version}",
            "documentNamespace": f"https://snug.invalid/spdx/snug-{version}-{digest[:16]}",
            "creationInfo": {"created": commit_time(), "creators": ["Tool: snug-sbom"]},
            "packages": [own] + debian + npm,
            "relationships": [{"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b} for a, kind, b in relations]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("program")
    parser.add_argument("--version", default="0.0.0")
    parser.add_argument("-o", "--output")
    words = parser.parse_args()
    text = json.dumps(describe(words.program, words.version), indent=1) + "\n"
    if words.output:
        draft = Path(words.output + ".draft")
        draft.write_text(text)
        draft.replace(words.output)
    else:
        sys.stdout.write(text)


if __name__ == "__main__":
    main()
