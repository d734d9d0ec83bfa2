"""Compare a rerun with a committed run's manifest.

``python -m softfinger.reproduction manifest FOLDER MANIFEST`` writes the manifest of the run in a
folder, ``… compare FOLDER MANIFEST`` reports of each file whether it is the same, and why not.
"""

import hashlib
import json
import math
import platform
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
import xarray as xr

from softfinger.faults import Fault
from softfinger.provenance import PROJECT

VERSION = 1
QUANTILES = {"q05": 0.05, "q25": 0.25, "median": 0.5, "q75": 0.75, "q95": 0.95}
TOLERANCE = {"rounding": 1e-4, "search": 0.01, "sampling": 0.3, "video": 0.02}
"""Share of a variable's scale that other processors, searches, draws and codecs may move."""
HASH = re.compile(r"\b[0-9a-f]{64}\b")
NUMBER = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:[eE][-+]?\d+)?")
KINDS = {
    **dict.fromkeys(("ranking", "location", "masking", "free_form", "laws", "model"), "search"),
    **dict.fromkeys(
        ("posterior", "sampling", "bands", "densities", "sobol", "shapley", "repair"), "sampling"
    ),
    **dict.fromkeys(("checks", "summary"), "sampling"),
}
"""What artifacts depend on, where it is more than rounding."""
REASONS = {
    "code_sha256": "the code of its stage",
    "params_sha256": "the configuration",
    "environment_sha256": "the locked packages",
    "inputs": "its inputs",
    "seed": "the seed",
}


class Answer(NamedTuple):
    """How a file compares; `good` within the tolerance."""

    name: str
    word: str
    good: bool
    why: str = ""


def write_manifest(folder: Path, path: Path) -> None:
    """Write every file's hash, provenance and summary."""
    files = {name: describe_file(folder / name) for name in list_files(folder)}
    content = {
        "version": VERSION,
        "made_on": describe_machine(),
        "tolerance": TOLERANCE,
        "files": files,
    }
    path.write_text(json.dumps(content, indent=1, sort_keys=True) + "\n", encoding="utf-8")


def describe_machine() -> dict[str, str]:
    """Kind of machine, hash of the lock."""
    lock = (PROJECT / "environment.lock").read_bytes()
    return {
        "processor": platform.machine(),
        "system": platform.system(),
        "python": platform.python_version(),
        "environment_sha256": hashlib.sha256(lock).hexdigest(),
    }


def list_files(folder: Path) -> list[str]:
    """Result files of a run, but logs, pages."""
    kinds = {".nc", ".json", ".yaml", ".csv", ".avi"}
    made = [p for p in folder.rglob("*") if p.is_file() and p.suffix in kinds]
    names = [p.relative_to(folder) for p in made]
    return sorted(
        name.as_posix()
        for name in names
        if not name.parts[0].startswith(".") and name.parts[0] not in {"logs", "figures"}
    )


def describe_file(path: Path) -> dict[str, Any]:
    """Hash of a file, its summary and provenance."""
    described: dict[str, Any] = {"sha256": hashlib.sha256(path.read_bytes()).hexdigest()}
    if path.suffix == ".json":
        verdict = json.loads(path.read_text(encoding="utf-8"))
        effects = [effect["id"] for effect in verdict["effects"]]
        described["says"] = f"{verdict['decision']}: {' + '.join(effects) or 'nothing'}"
    elif path.suffix == ".nc":
        described |= describe_artifact(path)
    elif path.suffix == ".avi":
        described["summary"] = {
            "grey level": summarise_values(read_first_frame(path).astype(float))
        }
    else:
        described |= describe_text(path.read_text(encoding="utf-8"))
    return described


def describe_text(text: str) -> dict[str, Any]:
    r"""Hash of a text, and summary of its numbers.

    Hashes that the text cites are left out.

    >>> describe_text("a: 1\nb: 3\n")["summary"]["numbers"]["median"]
    2.0
    """
    plain = HASH.sub("", text)
    numbers = np.array([float(number) for number in NUMBER.findall(plain)])
    summary = {"numbers": summarise_values(numbers)} if numbers.size else {}
    return {"values_sha256": hashlib.sha256(plain.encode()).hexdigest(), "summary": summary}


def read_first_frame(path: Path) -> np.ndarray:
    """First picture of a video.

    Raises
    ------
    Fault
        If it cannot be decoded.
    """
    capture = cv2.VideoCapture(str(path))
    read, picture = capture.read()
    capture.release()
    if not read:
        raise Fault(f"{path}: no picture can be decoded; run it again")
    return picture


def describe_artifact(path: Path) -> dict[str, Any]:
    """Hash, summary and provenance of an artifact's values."""
    with xr.open_datatree(path) as tree:
        attrs = {key: _plain(tree.attrs[key]) for key in REASONS if key in tree.attrs}
        digest, summary = hashlib.sha256(), {}
        for group in tree.subtree:
            for name, array in sorted(group.dataset.variables.items()):
                key = f"{group.path.strip('/')}/{name}".strip("/")
                values = np.ascontiguousarray(array.to_numpy())
                kind = values.dtype.str if values.dtype.kind not in "OUT" else "text"
                digest.update(f"{key} {array.dims} {values.shape} {kind}\n".encode())
                plain = values if kind != "text" else np.array("\n".join(values.astype(str).flat))
                digest.update(plain.tobytes() if kind != "text" else str(plain).encode())
                if values.dtype.kind == "f" and values.size:
                    summary[key] = summarise_values(values)
    return {"values_sha256": digest.hexdigest(), "made_by": attrs, "summary": summary}


def summarise_values(values: np.ndarray) -> dict[str, float]:
    """Quantiles of finite values, and the others' share.

    >>> summarise_values(np.array([0.0, 1.0, 2.0, np.nan]))["median"]
    1.0
    """
    finite = values[np.isfinite(values)]
    share = {"missing": 1.0 - finite.size / values.size}
    if not finite.size:
        return share
    found = np.quantile(finite, list(QUANTILES.values()))
    return share | {key: float(f"{q:.9g}") for key, q in zip(QUANTILES, found, strict=True)}


def compare_run(folder: Path, manifest: Path) -> Iterator[Answer]:
    """Compare a run with a manifest, file by file.

    Raises
    ------
    Fault
        If the manifest is missing or of another version.
    """
    if not manifest.is_file():
        raise Fault(f"{manifest} is missing; make manifest writes it from a run")
    known = json.loads(manifest.read_text(encoding="utf-8"))
    if known["version"] != VERSION:
        raise Fault(f"{manifest} has version {known['version']}; expected {VERSION}: make manifest")
    for name, was in known["files"].items():
        path = folder / name
        yield (
            compare_file(name, was, describe_file(path))
            if path.is_file()
            else Answer(name, "missing", False, "the run did not make it")
        )
    for name in sorted(set(list_files(folder)) - set(known["files"])):
        yield Answer(name, "new", True, "the manifest does not list it")


def compare_file(name: str, was: Mapping[str, Any], now: Mapping[str, Any]) -> Answer:
    """Compare one file's description with the manifest's."""
    if now["sha256"] == was["sha256"]:
        return Answer(name, "equal", True)
    if "says" in was:
        same = now["says"] == was["says"]
        words = f"the verdict is {now['says']}" + ("" if same else f"; was {was['says']}")
        return Answer(name, "within tolerance" if same else "different", same, words)
    why = explain(was.get("made_by", {}), now.get("made_by", {}))
    if "values_sha256" in was and now["values_sha256"] == was["values_sha256"]:
        return Answer(name, "equal values", True, why)
    allowed = choose_tolerance(name)
    far = list(list_deviations(was["summary"], now["summary"], allowed))
    if far:
        more = f" and {len(far) - 3} more" if len(far) > 3 else ""
        return Answer(name, "different", False, f"{'; '.join(far[:3])}{more}; {why}")
    return Answer(name, "within tolerance", True, f"{allowed:g} of the scale; {why}")


def choose_tolerance(name: str) -> float:
    """Allowed difference as a share of the scale."""
    kind = "video" if name.endswith(".avi") else KINDS.get(Path(name).stem, "rounding")
    return TOLERANCE[kind]


def list_deviations(
    was: Mapping[str, Mapping[str, float]], now: Mapping[str, Mapping[str, float]], allowed: float
) -> Iterator[str]:
    """Sentences on summaries that moved beyond the tolerance.

    The scale of a variable is the distance of its outer quantiles, or the largest quantile's
    size where they coincide.
    """
    for name in sorted(set(was) ^ set(now)):
        yield f"{name} is {'missing' if name in was else 'new'}"
    for name in sorted(set(was) & set(now)):
        old, new = was[name], now[name]
        scale = abs(old.get("q95", 0.0) - old.get("q05", 0.0))
        scale = scale or max((abs(old[key]) for key in QUANTILES if key in old), default=0.0)
        for key in old:
            moved = abs(new.get(key, math.inf) - old[key])
            if moved > allowed * (1.0 if key == "missing" else scale):
                yield f"{name}: {key} {new.get(key, math.nan):.6g}, was {old[key]:.6g}"
                break


def explain(was: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """The stamped reason why a file differs."""
    changed = [words for key, words in REASONS.items() if was.get(key) != now.get(key)]
    if not changed:
        return "no stamp shows why: another kind of machine, or another source"
    return f"changed: {', '.join(changed)}"


def tell(answers: list[Answer]) -> str:
    """The comparison in lines; equal files are counted."""
    counts = {word: sum(a.word == word for a in answers) for word in {a.word for a in answers}}
    lines = [f"{a.word}: {a.name}: {a.why}" for a in answers if a.word != "equal"]
    total = ", ".join(f"{n} {word}" for word, n in sorted(counts.items()))
    return "\n".join([*lines, f"{len(answers)} files: {total}"])


def _plain(value: object) -> str | int:
    return int(value) if isinstance(value, np.integer) else str(value)


def main(verb: str, folder: Path, manifest: Path) -> int:
    """Run one verb; 0 if all is well."""
    if verb == "manifest":
        write_manifest(folder, manifest)
        return 0
    answers = list(compare_run(folder, manifest))
    here, there = describe_machine(), json.loads(manifest.read_text(encoding="utf-8"))["made_on"]
    for key in (key for key in here if here[key] != there[key]):
        print(f"made elsewhere: {key} is {here[key]}, was {there[key]}")
    print(tell(answers))
    return 0 if all(answer.good for answer in answers) else 1


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])))
    except Fault as fault:
        sys.exit(f"softfinger: {fault}")
