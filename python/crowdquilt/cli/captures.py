"""`samples`, `inspect`, `patches`: from captures to a patch set."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from crowdquilt import inspection, motion, patch, samples
from crowdquilt._core import CrowdquiltError
from crowdquilt.cli.app import app, console, example, expect_picture
from crowdquilt.cli.progress import make_set
from crowdquilt.cli.tables import facts, kind_table, notes_of, take_table
from crowdquilt.outputs import whole_folder
from crowdquilt.plot.capture import capture as draw
from crowdquilt.plot.events import events as draw_events
from crowdquilt.plot.sheet import sheet as draw_sheet


@app.command("samples", epilog=example("samples -o out/samples"))
def write_samples(
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder to write to.")],
    seed: Annotated[int, typer.Option(min=0, help="Same seed, same files.")] = 1,
) -> None:
    """Write generated captures: people who walk, turn, sit, meet and touch.

    A BVH file for every person and a `.take.json` for every take, which says who touches whom, when feet are
    planted, and which patches to cut.
    """
    with whole_folder(out) as part:
        written = samples.write(part, seed)
    takes = sum(str(file).endswith(".take.json") for file in written)
    console.print(f"{out}: {takes} takes, {len(written) - takes} captures")


@app.command(
    "inspect",
    epilog=example(
        "inspect walk.bvh --preset cmu-mb",
        "inspect walk.bvh --plot walk.png",
        "inspect a.bvh b.bvh",
        "inspect out/demo/crowd.crowd --json",
    ),
)
def inspect_file(
    files: Annotated[
        list[Path], typer.Argument(help="A capture, several of one take, a patch set (.patches) or a crowd (.crowd).")
    ],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    plot: Annotated[Path | None, typer.Option(help="Draw a capture: path, foot plants, variation of the pose.")] = None,
    preset: Annotated[
        str | None, typer.Option(help="Repairs for well-known files: cmu-mb, cmu-max, cmu-daz, cmu-daz-128, cmu-asf.")
    ] = None,
    metres_per_unit: Annotated[float | None, typer.Option(help="Unit of a capture; guessed if not given.")] = None,
    fps: Annotated[float | None, typer.Option(help="True frames per second, where the header is wrong.")] = None,
    drop_first: Annotated[int | None, typer.Option(min=0, help="Leading frames (T-poses) to drop.")] = None,
    restore_thorax: Annotated[
        bool | None, typer.Option(help="Put back the bone that cgspeed's CMU files lost.", show_default=False)
    ] = None,
    rig: Annotated[
        Path | None, typer.Option(help="File that says which joint is which (hips = 'Pelvis', ...).")
    ] = None,
    character: Annotated[str | None, typer.Option(help="One of several people in the file: number or name.")] = None,
) -> None:
    """Tell what a file holds and what looks wrong with it; of several captures, whether they can be one take."""
    who = int(character) if character is not None and character.isdigit() else character
    where = str(rig.absolute()) if rig is not None else None
    repairs = inspection.Repairs(preset, metres_per_unit, fps, drop_first, restore_thorax, where, who)
    found = inspection.inspect(files[0], repairs) if len(files) == 1 else inspection.inspect_take(files, repairs)
    if plot is not None:
        draw([motion.load(file, **vars(repairs)) for file in files], plot)
    if as_json:
        print(json.dumps(found, indent=2))
    else:
        tell(found)


def readable(value: Any) -> Any:
    """The worst of something as figure, joint and time; times to hundredths; all else as it is."""
    if isinstance(value, tuple):
        figure, joint, secs = value
        return f"{figure:.1f} ({joint} at {secs:.2f} s)"
    if isinstance(value, list) and all(isinstance(v, float) for v in value):
        return ", ".join(f"{v:.2f}" for v in value) or "none"
    return value


def tell(found: dict[str, Any]) -> None:
    """Print what was found, the warnings last."""
    warnings, people = found.pop("warnings", []), found.pop("people", [])
    for person in people:
        tell(person)
        console.print()
    for apart in found.pop("distances", []):
        a, b = apart["people"]
        near, far = apart["nearest_m"], apart["farthest_m"]
        console.print(f"{escape(a)} and {escape(b)}: {near:.2f} to {far:.2f} m from each other")
    if not people:
        console.print(facts({name: readable(value) for name, value in found.items()}))
    for warning in warnings:
        console.print(f"[yellow]warning[/yellow] {escape(warning)}", soft_wrap=True)


@app.command(
    epilog=example(
        "patches out/samples -o samples.patches",
        "patches captures/index.csv -o mine.patches --takes found --plot events.png",
        "patches found --captures captures -o edited.patches",
        "patches out/samples --compose examples/compose -o out/composed.patches",
    )
)
def patches(
    sources: Annotated[
        list[Path],
        typer.Argument(help="Folders of captures or take files, indexes (.csv), take files or captures, all together."),
    ],
    out: Annotated[Path, typer.Option("--out", "-o", help="Patch set to write (.patches).")],
    captures: Annotated[Path | None, typer.Option(help="Folder of the captures, if not beside the take files.")] = None,
    takes: Annotated[
        Path | None, typer.Option(help="Folder for take files that say what was found: to edit, and cut again.")
    ] = None,
    threshold: Annotated[float | None, typer.Option(help="How near poses of a group are, in metres.")] = None,
    groups: Annotated[int | None, typer.Option(help="Most pose groups that patches begin and end with.")] = None,
    alone: Annotated[int | None, typer.Option(help="Most patches of one person, mirrored copies not counted.")] = None,
    touch_gap: Annotated[float | None, typer.Option(help="Bodies nearer than this touch, in metres.")] = None,
    near: Annotated[float | None, typer.Option(help="People nearer than this react to each other, in metres.")] = None,
    compose: Annotated[
        list[Path] | None, typer.Option(help="File (.compose.toml) that composes a patch by hand, or folder of them.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw why something is an event: what was measured, thresholds, what was found.")
    ] = None,
    sheet: Annotated[Path | None, typer.Option(help="Draw every kind: a contact sheet (.png, .svg, .pdf).")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Do not list takes and kinds.")] = False,
) -> None:
    """Make motion patches of captures, and their mirrored copies.

    Takes that say where to cut are cut there. In all others events between people are found (they touch, react to each
    other, act together), and a few recurring poses at which patches begin and end. Files that end in .compose.toml
    compose patches by hand of clips of the takes.
    """
    expect_picture(plot, sheet)
    options: dict[str, Any] = {"threshold": threshold, "groups": groups, "alone": alone, "touch_gap": touch_gap,
                               "near": near, "compose": expect_compose(compose)}  # fmt: skip
    try:
        made = make_set(sources, captures, **{name: value for name, value in options.items() if value is not None})
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    if not len(made.set):
        reasons = [f"{names}: {note}" for names, note in notes_of(made.takes)]
        raise CrowdquiltError(f"{', '.join(map(str, sources))}: nothing to make patches of: {'; '.join(reasons)}")
    out.parent.mkdir(parents=True, exist_ok=True)
    made.set.save(out)
    if plot is not None:
        draw_events(made, plot)
    if sheet is not None:
        draw_sheet(made.set, sheet)
    if takes is not None:
        with whole_folder(takes) as part:
            for name, text in made.take_files():
                (part / name).write_text(text)
    if as_json:
        print(json.dumps(set_facts(made), indent=2))
    else:
        tell_made(made, out, quiet)


def expect_compose(files: list[Path] | None) -> list[Path] | None:
    """Refuse folders that hold no compose file."""
    for folder in files or []:
        if folder.is_dir() and not any(folder.glob("*.compose.toml")):
            raise CrowdquiltError(f"{folder}: expected files that end in .compose.toml, found none")
    return files


def tell_made(made: patch.Made, out: Path, quiet: bool) -> None:
    """Print what was made of which take, what there is to say of takes, and the sum."""
    if not quiet:
        console.print(take_table(made.takes))
        console.print()
        console.print(kind_table(made.set, console.width))
        console.print()
    for names, note in notes_of(made.takes):
        console.print(f"[yellow]{escape(names)}[/yellow]: {escape(note)}", soft_wrap=True)
    found = set_facts(made)
    console.print(
        f"{out}: {found['kinds']} kinds and their mirror images, {found['single_person_kinds']} of one person, "
        f"{found['pose_groups']} pose groups, {'closed' if found['closed'] else 'not closed: see crowdquilt kinds'}",
        soft_wrap=True,
    )


def set_facts(made: patch.Made) -> dict[str, Any]:
    """What a set holds and what was found in each take; mirrored copies are not counted."""
    kinds = [kind for kind in made.set.kinds if not kind.mirrored]
    alone = sum(kind.people == 1 for kind in kinds)
    return {
        "kinds": len(kinds),
        "single_person_kinds": alone,
        "multi_person_kinds": len(kinds) - alone,
        "pose_groups": len(made.set.groups),
        "closed": patch.connectivity(made.set).closed,
        "takes": [
            {
                "name": take.name,
                "people": take.people,
                "annotated": take.annotated,
                "events": [
                    {"kind": kind, "people": people, "begin": round(begin, 3), "end": round(end, 3)}
                    for kind, people, begin, end in take.events
                ],
                "patches": take.patches,
                "together": round(take.together, 4),
                "notes": take.notes,
            }
            for take in made.takes
        ],
    }
