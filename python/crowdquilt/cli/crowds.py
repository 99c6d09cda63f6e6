"""`tile`, `check`, `export`: from a patch set to a crowd and on."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from crowdquilt import check, export, patch, report, samples
from crowdquilt._core import Checkpoint, Crowd, CrowdquiltError, Outcome, PatchSet, Scene
from crowdquilt.cli import keeping
from crowdquilt.cli.app import CHECK_FAILED, ENDS, VERDICTS, app, console, example
from crowdquilt.cli.progress import solve
from crowdquilt.cli.tables import check_table
from crowdquilt.cli.world import check_world
from crowdquilt.world import holds_world


class Method(StrEnum):
    """How to tile."""

    engine = "engine"
    paper = "paper"


def tell(outcome: Outcome) -> None:
    """One line on how a solve ended."""
    people, patches = len(outcome.crowd), len(outcome.crowd.instances)
    made = f"{people} people, {patches} patches, {outcome.danglings} danglings in {outcome.solve_secs:.2f} s"
    console.print(f"{VERDICTS[outcome.status]}: {made}{'; ' if outcome.reason else ''}{outcome.reason}", soft_wrap=True)


@app.command(
    epilog=example(
        "tile samples.patches --scene plaza.toml -o plaza.crowd --seed 7",
        "tile --resume plaza.tiling",
        "tile --resume plaza.tiling --density 0.7 -o denser.crowd",
    )
)
def tile(
    patches: Annotated[
        Path | None,
        typer.Argument(
            help="Patch set (.patches), or `samples`: cut from the generated captures. "
            "With --resume the one of the earlier run, if not given."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="Crowd to write (.crowd). With --resume beside the checkpoint, if not given."),
    ] = None,
    scene: Annotated[Path | None, typer.Option(help="Scene (.toml); the demo's 12 x 12 m if not given.")] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Same seed, same crowd; 1 if not given.")] = None,
    method: Annotated[Method, typer.Option(help="Our engine, or Algorithms 1 and 2 of the paper.")] = Method.engine,
    time: Annotated[
        float,
        typer.Option(min=0, help="Longest time for search and bodies, in seconds. With --resume, 0 only reports."),
    ] = 60.0,
    characters: Annotated[int | None, typer.Option(help="How many people, instead of the scene's.")] = None,
    density: Annotated[float | None, typer.Option(help="How many per square metre, instead of the scene's.")] = None,
    interaction: Annotated[
        float | None, typer.Option(help="Share of their time together, 0 to 1, instead of the scene's.")
    ] = None,
    threads: Annotated[int | None, typer.Option(min=1, help="Threads; all cores if not given.")] = None,
    report_to: Annotated[
        Path | None, typer.Option("--report", help="Also check the crowd and write report.json.")
    ] = None,
    resume: Annotated[
        Path | None, typer.Option(help="Go on from a checkpoint (.tiling) with its scene, patch set and seed.")
    ] = None,
    checkpoint: Annotated[
        Path | None,
        typer.Option(help="Write checkpoints here and leave the last one; else beside the crowd until it is perfect."),
    ] = None,
    no_checkpoint: Annotated[bool, typer.Option("--no-checkpoint", help="Write no checkpoints.")] = False,
) -> None:
    """Tile a scene with motion patches until no end is loose and nobody collides.

    Every ten seconds, and when the search ends or is stopped by Ctrl-C or SIGTERM, the tiling is written to a
    checkpoint beside the crowd. A run that was killed goes on from it with --resume.

    Whatever was reached is saved. Exit code 0: perfect. 3: clean, but short of what was wished for. 4: faults or loose
    ends are left. 2: bad input.
    """
    kept = Checkpoint.load(resume) if resume else None
    set_file = keeping.set_file(patches, kept, resume)
    if not time > 0 and not kept:
        raise typer.BadParameter(f"expected more than 0 seconds, found {time}", param_hint="--time")
    if scene and kept:
        raise typer.BadParameter("a checkpoint has its scene: expected no other", param_hint="--scene")
    kinds = load_set(set_file)
    where = kept.scene if kept else Scene.load(scene) if scene else Scene.demo()
    where = where.replace(characters=characters, density=density, interaction=interaction)
    if kept and not time > 0:
        raise typer.Exit(keeping.report(kept, where, kinds))
    crowd_file = keeping.crowd_file(out, resume)
    plan = keeping.plan(crowd_file, checkpoint, no_checkpoint or method == Method.paper)
    try:
        outcome = solve(
            where,
            kinds,
            seed=seed if seed is not None else kept.seed if kept else 1,
            method=method,
            time=time,
            threads=threads,
            resume=kept,
            checkpoint=plan.file,
            patches_name=str(set_file),
        )
    except CrowdquiltError as error:
        # The core speaks of "scene" and "patch set"; the user knows them by their files.
        raise CrowdquiltError(name_files(str(error), scene, set_file, resume)) from None
    crowd_file.parent.mkdir(parents=True, exist_ok=True)
    outcome.crowd.save(crowd_file)
    if report_to:
        written = Crowd.load(crowd_file)  # the report is about the file, whose numbers are rounded
        report.save(report.build(written, check.check(written), outcome), report_to)
    tell(outcome)
    console.print(f"{crowd_file}: written")
    plan.finish(outcome)
    if code := ENDS[outcome.status]:
        raise typer.Exit(code)


def load_set(patches: Path) -> PatchSet:
    """A patch set from its file; `samples` is the one cut from the generated captures."""
    if str(patches) != "samples" or patches.exists():
        return PatchSet.load(patches)
    with TemporaryDirectory() as folder:
        samples.write(folder, seed=1)
        return patch.cut(folder)


def name_files(message: str, scene: Path | None, patches: Path, resume: Path | None) -> str:
    """A message of the core with the file in front, where it names only the kind of input."""
    for origin, file in (("scene: ", scene), ("patch set: ", patches), ("checkpoint: ", resume)):
        if file and message.startswith(origin):
            return f"{file}: {message.removeprefix(origin)}"
    return message


@app.command("check", epilog=example("check out/demo/crowd.crowd", "check out/city.world"))
def check_file(
    crowd: Annotated[Path, typer.Argument(help="Crowd (.crowd) or world (.world).")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
) -> None:
    """Verify a finished crowd or world from its file alone. Exit code 1 if a row fails."""
    if holds_world(crowd):
        check_world(crowd, as_json)
        return
    found = Crowd.load(crowd)
    result = check.check(found)
    if as_json:
        print(json.dumps(report.build(found, result), indent=2))
    else:
        console.print(check_table(result))
        failed = len(result.failures)
        verdict = f"[red]{failed} of {len(result.rows)} rows fail[/red]" if failed else "[green]every row holds[/green]"
        console.print(verdict)
    if not result.ok:
        raise typer.Exit(CHECK_FAILED)


def unrolled(crowd: Crowd, times: str) -> Crowd:
    """A block of a crowd that repeats; `times` is tiles along x and z, and laps if there are three numbers."""
    counts = times.split("x")
    if len(counts) not in (2, 3) or not all(c.isdecimal() and 1 <= int(c) <= 99 for c in counts):
        raise typer.BadParameter(f"expected something like 3x3 or 3x3x2, found {times}", param_hint="--unroll")
    x, z, t = (int(c) for c in [*counts, "1"][:3])
    return crowd.unrolled(x, z, t)


@app.command(
    "export",
    epilog=example(
        "export plaza.crowd -o plaza.glb",
        "export plaza.crowd -o plaza.glb --character ann.glb --character bob.glb",
        "export plaza.crowd -o plaza_bvh",
        "export tile.crowd -o block.glb --unroll 3x3",
    ),
)
def export_file(
    crowd: Annotated[Path, typer.Argument(help="Crowd (.crowd).")],
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="A .glb file; a .bvh file of one person; or a folder for all BVH files."),
    ],
    person: Annotated[int | None, typer.Option(help="Which person goes into the .bvh file.")] = None,
    character: Annotated[
        list[Path] | None,
        typer.Option(help="Your own skinned humanoid (.glb) in place of the mannequin; repeat it to deal out several."),
    ] = None,
    unroll: Annotated[
        str | None,
        typer.Option(help="Of a crowd that repeats so many tiles along x and z and laps, such as 3x3 or 3x3x2."),
    ] = None,
) -> None:
    """Write a crowd for other programs: glTF with skinned, animated people, or BVH."""
    found = Crowd.load(crowd)
    if unroll is not None:
        found = unrolled(found, unroll)
    if character and out.suffix != ".glb":
        raise typer.BadParameter(f"characters go into .glb files: found {out}", param_hint="--character")
    match out.suffix:
        case ".glb":
            export.save_glb(found, out, character or ())
            console.print(f"{out}: {len(found)} people")
        case ".bvh":
            if person is None or not 0 <= person < len(found):
                problem = f"a .bvh file holds one person: expected --person 0 to {len(found) - 1}, found {person}"
                raise typer.BadParameter(problem, param_hint="--person")
            export.save_person(found, person, out)
            console.print(f"{out}: person {person}")
        case "":
            export.save_bvh(found, out)
            console.print(f"{out}: {len(found)} BVH files")
        case other:
            raise CrowdquiltError(f"{out}: expected .glb, .bvh or a folder, found {other}")
