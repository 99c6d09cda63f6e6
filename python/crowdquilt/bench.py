"""What we reach beside the reference, row by row. Every area of the project adds its own function to `AREAS`."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from math import sin
from pathlib import Path
from statistics import median

from rich.table import Table

from crowdquilt import bench_steering, bench_walks, motion, patch, refine, samples
from crowdquilt._core import PatchSet, Scene, measure_patches, measure_poses, measure_replay, measure_street, tile
from crowdquilt.bench_row import Row, row
from crowdquilt.bench_tiling import EXAMPLES, PAPER, STATIC, example, growth, planes, repeating, static

Say = Callable[[str], None]


def tiling(seeds: int, say: Say, patches: PatchSet | None = None) -> list[Row]:
    """The paper's scenes, denser ones and larger ones; with another patch set those that it can play.

    The published number of people is reached with so many patches by any set; the samples' one is given more people.
    """
    published = patches is not None
    if patches is None:
        with tempfile.TemporaryDirectory() as folder:
            samples.write(Path(folder), 1)
            patches = patch.cut(Path(folder))
    rows = [found for scene in STATIC for found in static(scene, patches, seeds, say, published)]
    rows += [found for scene in EXAMPLES for found in example(scene, patches, seeds, say)]
    rows += repeating(patches, seeds, say)
    rows += planes(patches, say)
    rows += growth(patches, say)
    return [row("tiling", "kinds to choose from", len(patches), "", 43, PAPER), *rows]


MINUTES = 1.0


def captures(seeds: int, say: Say) -> list[Row]:
    """Frames per second of each importer on a generated walk; beside it the readers on PyPI, where installed."""
    with tempfile.TemporaryDirectory() as folder:
        samples.write(Path(folder), 1)
        bvh = long_bvh(Path(folder) / "walk-normal-a.bvh", Path(folder) / "long.bvh")
        amc = long_amc(Path(folder) / "long.amc")
        ours = {path: rate(partial(frames_of, path), seeds) for path in (bvh, amc)}
        say(f"motion: BVH {ours[bvh]:.0f} and AMC {ours[amc]:.0f} frames/s")
        rows = [row("motion", "AMC import", ours[amc], "frames/s")]
        for name, read in public_readers().items():
            theirs = rate(partial(read, bvh), 1)
            say(f"motion: {name} {theirs:.0f} frames/s")
            rows.append(
                row("motion", f"BVH import beside {name}", ours[bvh], "frames/s", theirs, f"{name}, here and now")
            )
        patches = patch.cut(Path(folder))
    return [row("motion", "BVH import", ours[bvh], "frames/s"), *rows, refinement(patches, seeds, say)]


def refinement(patches: PatchSet, runs: int, say: Say) -> Row:
    """Character-frames of full bodies made per second, from the fragments of a crowd."""
    crowd = tile(Scene.demo().replace(characters=30, interaction=0.1), patches, seed=1).crowd
    frames = sum(len(crowd.roots(person)) for person in range(len(crowd)))

    def again() -> int:
        refine.refine_crowd(crowd)
        return frames

    found = rate(again, runs)
    say(f"motion: refinement {found:.0f} character-frames/s")
    return row("motion", "refinement of full bodies", found, "character-frames/s")


def frames_of(path: Path) -> int:
    """Imports a capture; the number of its frames."""
    return motion.load(path).frames


def rate(read: Callable[[], int], runs: int) -> float:
    """Frames per second: the median over the runs."""
    found = []
    for _ in range(runs):
        begin = time.perf_counter()
        frames = read()
        found.append(frames / (time.perf_counter() - begin))
    return median(found)


def long_bvh(sample: Path, path: Path) -> Path:
    """The sample's frames again and again, for `MINUTES` at 120 a second."""
    head, motion_part = sample.read_text().split("MOTION\n")
    frames = motion_part.splitlines()[2:]
    wanted = int(MINUTES * 60 * 120)
    lines = (frames * (wanted // len(frames) + 1))[:wanted]
    path.write_text(f"{head}MOTION\nFrames: {wanted}\nFrame Time: 0.00833333\n" + "\n".join(lines) + "\n")
    return path


def long_amc(path: Path) -> Path:
    """A figure of 30 bones in three chains, swinging, as AMC with its ASF."""
    bones = [f"bone{i}" for i in range(30)]
    data = "".join(
        f"begin\nid {i + 1}\nname {b}\ndirection 0 1 0\nlength 3\naxis 0 0 20 XYZ\ndof rx ry rz\nend\n"
        for i, b in enumerate(bones)
    )
    tree = "".join(f"{bones[i - 1] if i % 10 else 'root'} {b}\n" for i, b in enumerate(bones))
    root = ":root\norder TX TY TZ RX RY RZ\naxis XYZ\nposition 0 0 0\norientation 0 0 0\n"
    units = ":units\nlength 0.45\nangle deg\n"
    path.with_suffix(".asf").write_text(f"{units}{root}:bonedata\n{data}:hierarchy\nbegin\n{tree}end\n")
    with path.open("w") as out:
        out.write(":FULLY-SPECIFIED\n:DEGREES\n")
        for frame in range(int(MINUTES * 60 * 120)):
            angle = 20 * sin(frame / 40)
            angles = f"{angle:.5f} {angle / 2:.5f} {-angle:.5f}"
            turns = "\n".join(f"{bone} {angles}" for bone in bones)
            out.write(f"{frame + 1}\nroot 0 17.5 {frame / 100:.5f} 0 {angle:.5f} 0\n{turns}\n")
    return path


def public_readers() -> dict[str, Callable[[Path], int]]:
    """What reads BVH on PyPI, of what is installed: each delivers the number of frames it has read."""
    readers: dict[str, Callable[[Path], int]] = {}
    with suppress(ImportError):
        import bvhio

        readers["bvhio"] = lambda path: bvhio.readAsBvh(str(path)).FrameCount
    with suppress(ImportError):
        import bvh

        readers["bvh"] = lambda path: bvh.Bvh(path.read_text()).nframes
    return readers


CROWD_PATCHES = "Yersin et al. 2009, section 6"
TARGET = "what we set out to reach"


def worlds(seeds: int, say: Say) -> list[Row]:
    """How long crowd patches take, and a walk through 10 km of endless street; the paper: 60 ms for a patch."""
    rows = []
    for name, walkers, reference in (("patch-create", 16, 60.0), ("patch-create-dense", 30, None)):
        typical, most_of_all, most, free = measure_patches(walkers, 60 * seeds, False)
        say(f"world: {name}: {typical:.2f} ms, {free:.1%} free of faults")
        title = f"{name}: {walkers} in and out, median"
        rows.append(row("world", title, typical, "ms", reference, CROWD_PATCHES if reference else ""))
        rows.append(row("world", f"{name}: 95 %", most_of_all, "ms", 3.0 if walkers == 16 else None, TARGET))
        rows.append(row("world", f"{name}: slowest", most, "ms"))
        rows.append(row("world", f"{name}: share without any fault", free))
    typical, _, _, free = measure_patches(16, 20 * seeds, True)
    rows.append(row("world", "the paper's particles here: median", typical, "ms"))
    rows.append(row("world", "the paper's particles here: share without any fault", free))
    rows += bench_walks.distributions()
    made, resident, typical, _, most = measure_street(10_000)
    say(f"world: endless-street: {made} patches, {most:.2f} ms at most")
    rows.append(row("world", "endless-street: 10 km, patches made", made))
    rows.append(row("world", "endless-street: patches kept at most", resident))
    rows.append(row("world", "endless-street: frame with a new patch, median", typical, "ms"))
    rows.append(row("world", "endless-street: frame with a new patch, slowest", most, "ms", 16.0, TARGET))
    return rows


def stage(seeds: int, say: Say) -> list[Row]:
    """A million people played on one core; the paper: 3,700 people at 30 to 35 frames per second, drawn."""
    rows = []
    steering = "steering, best of those measured: 1.5 M agent-steps/s"
    with tempfile.TemporaryDirectory() as folder:
        samples.write(Path(folder), 1)
        people, nanos = measure_poses(patch.cut(Path(folder)))
    say(f"stage: replay-poses: {nanos:.0f} ns a body")
    rows.append(
        row("stage", "replay-poses: a full body (22 joints)", nanos / 1e3, "us", 1.06, "ozz-animation, 31 joints")
    )
    others = bench_steering.measured(say)
    for name, kinds, unique in (("1,000 shared kinds", 1000, False), ("unique patches", 1000, True)):
        runs = [measure_replay(1_000_000, kinds, unique) for _ in range(max(1, seeds // 2))]
        people, _, memory = runs[0][:3]
        early, late, single = (median(run[i] for run in runs) for i in (3, 4, 5))
        say(f"stage: {name}: {early / 1e6:.0f} M root samples/s")
        rows.append(row("stage", f"replay-roots, {name}: at 1 s", early / 1e6, "M/s", 1.5, steering))
        rows.append(row("stage", f"replay-roots, {name}: at 1 h", late / 1e6, "M/s", 1.5, steering))
        for other, rate in others.items():
            source = f"{other} on the same street, here and now: agent-steps"
            rows.append(row("stage", f"replay-roots, {name}: beside {other}", early / 1e6, "M/s", rate / 1e6, source))
        rows.append(row("stage", f"{name}: people", people))
        rows.append(row("stage", f"{name}: in memory", memory / 1e6, "MB", 600.0 if unique else 64.0, TARGET))
        rows.append(row("stage", f"random-access, {name}: a patch at any time", single, "us"))
    return rows


AREAS: dict[str, Callable[..., list[Row]]] = {
    "motion": captures,
    "tiling": tiling,
    "world": worlds,
    "stage": stage,
}


def table(rows: list[Row]) -> Table:
    """The rows as one reads them."""
    made = Table(box=None, header_style="dim", padding=(0, 2, 0, 0), caption_justify="left", caption_style="dim")
    for title in ("area", "row", "ours", "reference", "unit", "ratio"):
        made.add_column(title, justify="right" if title in ("ours", "reference", "ratio") else "left")
    for r in rows:
        reference = "" if r.reference is None else f"{r.reference:.6g}"
        ratio = "" if r.ratio is None else f"{r.ratio:.3g}"
        made.add_row(r.area, r.row, f"{r.ours:.4g}", reference, r.unit, ratio)
    made.caption = "\n".join(["reference:", *dict.fromkeys(r.source for r in rows if r.source)])
    return made
